"""Figures and tables for papers beside the report's page, which saves its own figures as SVG.

    canvas          how figures look and are saved
    classes, curves, friction   figures; each function returns one, or None where the inputs do not have the part
    write           all files
"""

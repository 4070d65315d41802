"""Figures and tables for papers: what stands beside the report's page.

    canvas          how figures look and are saved
    times, curves   figures; each function returns one, or None where the inputs do not have the part
    write           all files
"""

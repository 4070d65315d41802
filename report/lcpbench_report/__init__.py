"""The report of LCPBench: campaigns' folders in; a page, figures, tables and words out. It reads result files only
(benchmarks/RESULTS.md), and every number comes from them.

    statistics                  reads a campaign, and the tables that `lcpbench analyse` writes
    inputs, studies             all that one report is made of
    choice                      what is shown where not all can be; which solver to take, by one rule
    headline_table, shown_tables, table   tables that people read, as Markdown, HTML and LaTeX
    summary, fairness           what the data say, and what they cannot
    charts                      charts as plain data, for the page and for files
    web, static, markdown       the page; figures and tables for papers; summary.md
    readme_blocks               numbers in README.md and docs/
    comparison                  what changed between two campaigns
    sentences                   the words of all of these: templates, *.md.j2
    style, solver_facts, formats   how solvers look and are spoken of, and numbers as text
    tuning                      settings by `lcpbench tune`
    compact                     campaigns that are kept with the source
"""

"""The report of LCPBench: campaigns' folders in; a page, figures, tables and words out. It reads result files only
(benchmarks/RESULTS.md), and every number comes from them.

    statistics                  reads a campaign, and the tables that `lcpbench analyse` writes
    inputs, motion, csv_table   all that one report is made of
    choice, decision            what is shown where not all can be; which solver to take, by one rule
    summary, fairness           sentences made of the data
    web                         the interactive page
    static, markdown_*, headline_table    figures and tables for papers, summary.md, numbers in README.md and docs/
    style, formats              how solvers look, and numbers as text
    archive                     campaigns that are kept with the source
    recommendation, tuning      rules of `lcpbench recommend`, settings chosen by `lcpbench tune`
"""

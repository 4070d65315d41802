"""The report of LCPBench: result files in, one self-contained HTML page out.

    load, timing   read and check the files                    (the only modules that touch the results folder)
    cells          joins accuracy and timing                   (the only module that decides which time counts)
    stats          performance profile, slope, geometric mean  (pure mathematics, no file or column names)
    summary, tables, limitations                               (words and rows made from cells)
    figures, svg, style, formats                               (how it looks)
    page           puts it together with page.html.j2

Every number on the page comes from the result files; benchmarks/RESULTS.md is their schema.
"""

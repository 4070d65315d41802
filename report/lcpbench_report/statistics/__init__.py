"""The statistics of a campaign: its folder in, tidy CSV tables out (benchmarks/RESULTS.md, "Campaign folders").

    fields, jsonl, load, steps, streams, records
                          read and check the files            (the only modules that touch the campaign's folder)
    model                 a campaign in memory, the same for streams and compact records
    cells                 one row per cell, and which time counts
    launches              one row per launch: levels and quantiles; their part in intervals
    groups                what is compared with what
    intervals             confidence intervals and multiple comparisons
    coverage, class_times, rivals, means, origins
                          tables, from the tables of cells and launches
    latency               the tables of sequences: steps of motions, warm starts, deadlines
    tables                all tables, by name
    changes               two campaigns: which answers differ, and how far what is published moved

Every table is a pure function of the table of cells, or of the passes over sequences; random numbers come from a
fixed seed.
"""

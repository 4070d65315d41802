#!/usr/bin/python3
"""Makes the rules of `lcpbench recommend` of campaigns, and tries them on families that they were not made of.

    lcpbench collection write data/standard.json | lcpbench recommend --features - > features.jsonl
    report/recommendation.py build/campaigns/standard --features features.jsonl -o data/recommendation.json

`make recommendation CAMPAIGNS=...` does both. Exit status: 0, or 2 with one line on standard error.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = script.Parser(description="Make the rules of `lcpbench recommend` of campaigns, and try them.")
    parser.add_argument("campaigns", type=Path, nargs="+", metavar="DIR", help="folder of a campaign on problems, or on sequences")
    parser.add_argument("--features", type=Path, required=True, metavar="FILE",
                        help="of all problems, written by `lcpbench recommend --features`")
    parser.add_argument("--leave-out", default="", metavar="FAMILIES",
                        help="make the rules without these families (commas), and do not try them")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE", help="JSON")
    options = parser.parse_args(arguments)

    def act() -> None:
        from lcpbench_report.recommendation import evaluation, record
        from lcpbench_report.recommendation.outcomes import read_outcomes, read_sequences

        outcomes = read_outcomes(options.campaigns, options.features)
        made = record.make(outcomes, read_sequences(options.campaigns),
                           frozenset(filter(None, options.leave_out.split(","))))
        record.write(made, options.output)
        if made["evaluation"]:
            print(evaluation.as_text(made["evaluation"]))
        print(f"{options.output}: {len(made['regions'])} regions")

    return script.guarded("recommendation.py", act)


if __name__ == "__main__":
    sys.exit(main())

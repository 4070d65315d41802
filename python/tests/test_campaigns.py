"""Campaigns of functions of Python: judged and timed as all solvers, whatever they do."""

import time

import lcpbench
import numpy as np
import pytest

SMALL = {"filter": "solve/(discs-in-v|gear-train)-n8", "launches": 1, "tiers": [1e-6]}


def calls_auto(problem, tolerance):
    """As right as auto, by a Result."""
    return lcpbench.solve(problem, tolerance=tolerance)


def gauss_seidel(problem, sweeps=300):
    A, b, bilateral = problem.A, problem.b, problem.bilateral
    f = np.zeros(len(b))
    for _ in range(sweeps):
        for i in range(len(b)):
            f[i] -= (A[i] @ f + b[i]) / A[i, i]
            if not bilateral[i]:
                f[i] = max(f[i], 0)
    return f


def zeros(problem):
    return np.zeros(len(problem))


def raises(problem):
    raise ArithmeticError("no pivot at all")


def refuses(problem):
    raise NotImplementedError("too difficult")


def too_short(problem):
    return np.zeros(len(problem) - 1)


@pytest.fixture(scope="module")
def campaign():
    return lcpbench.run("smoke", ["auto", calls_auto, gauss_seidel, zeros, raises, refuses, too_short], **SMALL)


def of(campaign, solver):
    found = campaign.tasks[campaign.tasks["solver"] == solver]
    assert len(found) == 2
    return found


def test_a_right_function_is_verified_and_timed_as_others(campaign):
    auto, function = of(campaign, "auto"), of(campaign, "calls_auto")
    assert (auto["verdict"] == "verified").all() and (function["verdict"] == "verified").all()
    assert (function["timed"] > 0).any() and np.isfinite(function["time_s"]).all()  # one of two warms a pass
    assert function["rho"].to_numpy() == pytest.approx(auto["rho"].to_numpy())
    assert (of(campaign, "gauss_seidel")["verdict"] == "verified").all()


def test_the_cost_of_a_call_is_measured_for_functions_only(campaign):
    functions = campaign.tasks[campaign.tasks["solver"] != "auto"]
    assert (functions.loc[functions["claim"] != "", "call_s"] > 0).all()
    assert of(campaign, "auto")["call_s"].isna().all()
    function = of(campaign, "calls_auto")
    assert (function["call_s"] < function["time_s"]).all()
    assert campaign.summary.set_index("solver").loc["calls_auto", "call_s"] > 0


def test_what_functions_do_wrong_is_a_result_with_its_reason(campaign):
    assert (of(campaign, "zeros")["verdict"] == "false success").all()
    assert np.isinf(of(campaign, "zeros")["time_s"]).all()
    for solver, claim, text in (("raises", "numerical_failure", "ArithmeticError: no pivot at all"),
                                ("refuses", "unsupported", "NotImplementedError: too difficult"),
                                ("too_short", "numerical_failure", "the function's f: has 7 entries, expected n = 8")):
        tasks = of(campaign, solver)
        assert (tasks["claim"] == claim).all()
        assert tasks["detail"].str.contains(text, regex=False).all(), tasks["detail"].tolist()
    assert (of(campaign, "refuses")["verdict"] == "not asked").all()


def test_the_summary_adds_up(campaign):
    summary = campaign.summary
    counts = summary[["verified", "false_successes", "below_tier", "failed", "out_of_time", "not_asked"]].sum(axis=1)
    assert (counts == summary["problems"]).all() and (summary["problems"] == 2).all()
    assert summary["solver"].tolist() == ["auto", "calls_auto", "gauss_seidel", "zeros", "raises", "refuses", "too_short"]


def test_tables_are_those_of_the_folder(campaign):
    tables = lcpbench.tables(campaign.folder)
    assert len(tables["cells"]) == len(campaign.tasks)
    assert set(tables["coverage"]["solver"]) == set(campaign.summary["solver"])
    with pytest.raises(ValueError, match="not a folder"):
        lcpbench.tables("/no/such/folder")["cells"]


def test_own_problems_with_friction_and_variants(tmp_path):
    scenes = {f"house-{seed}": lcpbench.generate("three-discs", 12, seed) for seed in (1, 2)}
    scenes["plain"] = lcpbench.Problem(np.array([[2.0, 1.0], [1.0, 2.0]]), [-1.0, 1.0])

    def with_friction(problem):
        return lcpbench.solve(problem)

    campaign = lcpbench.run(scenes, {"auto": "auto", "mine": with_friction, "sweeps": "pgs"}, tiers=[1e-3],
                            launches=1, folder=tmp_path / "own")
    assert set(campaign.tasks["problem"]) == set(scenes)
    mine = campaign.tasks[campaign.tasks["solver"] == "mine"]
    assert (mine["verdict"] == "verified").all()
    assert set(campaign.tasks["solver"]) == {"auto", "mine", "sweeps"}


def test_a_function_that_does_not_come_back_is_given_up_and_stopped():
    ended = []

    def endless(problem):
        try:
            while True:
                time.sleep(0.01)
        finally:
            ended.append(len(problem))

    campaign = lcpbench.run("smoke", {"endless": endless}, filter="solve/discs-in-v-n8", launches=1, tiers=[1e-6],
                            time_limit=0.1)
    assert campaign.tasks["claim"].tolist() == ["time_limit"]
    assert set(ended) == {8}


@pytest.mark.parametrize("solvers, what", [
    ([], "at least one"), ([zeros, zeros], "the same name"), ([lambda problem: None], "<lambda>"), ([3], "int"),
    ({"Mine": zeros}, "Mine"), ([lcpbench], "module"), ({"none": lambda: None}, "none"),
    (["no-such-solver"], "no-such-solver"),
])
def test_wrong_solvers_are_named(solvers, what):
    with pytest.raises(ValueError, match=what):
        lcpbench.run("smoke", solvers, **SMALL)


def test_wrong_suites_are_named(tmp_path):
    with pytest.raises(ValueError, match="no-such-suite"):
        lcpbench.run("no-such-suite")
    with pytest.raises(ValueError, match="first"):
        lcpbench.run({"first": 3}, folder=tmp_path / "a")
    with pytest.raises(ValueError, match="at least one problem"):
        lcpbench.run([], folder=tmp_path / "b")

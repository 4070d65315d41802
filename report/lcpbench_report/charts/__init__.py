"""Charts of a report: described once as plain data, shown on the page by Plotly and drawn as files by Matplotlib.

    chart       what a chart is
    campaign, motion   charts of problems; of steps and motions
    drawing, plotly    what draws them
"""

from ..inputs import Inputs
from . import campaign, motion
from .chart import Figure


def figures(inputs: Inputs) -> list[Figure]:
    return [figure for part in (campaign, motion) for figure in part.figures(inputs)]

"""Files of solutions, recordings and worlds, tables and reports."""

from kickdrift.io.loading import load
from kickdrift.io.pandas import to_pandas
from kickdrift.io.report import report
from kickdrift.io.solution_file import save
from kickdrift.io.xarray import to_xarray

__all__ = ["load", "report", "save", "to_pandas", "to_xarray"]

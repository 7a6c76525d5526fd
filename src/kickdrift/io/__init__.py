"""What people keep: solution files, tables and reports."""

from kickdrift.io.report import report
from kickdrift.io.solution_file import load, save
from kickdrift.io.xarray import to_xarray

__all__ = ["load", "report", "save", "to_xarray"]

"""The heavy libraries, loaded once in the process from which the processes of all trials are forked."""

import h5netcdf
import jinja2
import matplotlib.pyplot
import numba
import numpy
import pydantic
import scipy.integrate
import scipy.interpolate
import scipy.linalg
import scipy.optimize
import skfem
import xarray

import validation.faults.trial

__all__ = ["h5netcdf", "jinja2", "matplotlib", "numba", "numpy", "pydantic", "scipy", "skfem", "validation", "xarray"]

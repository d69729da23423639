"""The exact flow of one contact state as an `OdeSolver` for `scipy.integrate.solve_ivp`."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import DenseOutput, OdeSolver

from fe_lapjoint.march.coupled import flow_from
from fe_lapjoint.march.ramp_march import motion_of
from fe_lapjoint.march.system import Coordinates, System
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray


class _ExactDense(DenseOutput):  # type: ignore[misc]
    """The motion within a step, by the flow itself."""

    def __init__(self, t_old: float, t: float, flow: Coordinates) -> None:
        super().__init__(t_old, t)
        self._flow = flow

    def _call_impl(self, t: FloatArray) -> FloatArray:
        times = np.atleast_1d(t)
        y = np.concatenate([self._flow(times, 0), self._flow(times, 1)])
        return np.asarray(y if np.ndim(t) else y[:, 0])


class ExactPropagator(OdeSolver):  # type: ignore[misc]
    """Exact stepping of a linear `System` between events, as a method of `scipy.integrate.solve_ivp`.

    Parameters
    ----------
    fun, t0, y0, t_bound, vectorized :
        As for every `OdeSolver`; ``y`` = (q, q'), kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``.
    system : System
        The linear system; `fun` is not called.
    max_step : float
        Longest step, s; every step is exact, so only the spacing of the output depends on it.

    Raises
    ------
    InputError
        If the system has sampled forces and is to be followed back in time.
    """

    t: float
    y: FloatArray

    def __init__(
        self,
        fun: Any,
        t0: float,
        y0: FloatArray,
        t_bound: float,
        vectorized: bool = False,
        *,
        system: System,
        max_step: float = np.inf,
        **_: Any,
    ) -> None:
        super().__init__(fun, t0, y0, t_bound, vectorized)
        if system.ramps is not None and t_bound < t0:
            raise InputError("ExactPropagator: sampled forces are followed forward in time only")
        self._system, self._max_step = system, max_step
        self._flow: Coordinates = self._from(t0, np.asarray(y0, dtype=float))

    def _from(self, t: float, y: FloatArray) -> Coordinates:
        """The motion from given coordinates on."""
        if self._system.ramps is None:
            return flow_from(self._system, t, y)
        return motion_of(self._system, t, y)

    def _step_impl(self) -> tuple[bool, str | None]:
        now = self.t
        t = now + self.direction * min(self._max_step, abs(self.t_bound - now))
        if self._system.ramps is not None:
            end = self._system.ramps.ramps.block_at(now).end
            t = min(t, end) if end > now else t
        self._flow, at = self._from(now, self.y), np.array([t])
        self.y = np.concatenate([self._flow(at, dt)[:, 0] for dt in (0, 1)])
        self.t = t
        return True, None

    def _dense_output_impl(self) -> DenseOutput:
        return _ExactDense(self.t_old, self.t, self._flow)

"""One contact state under forces that are linear in time, as flat arrays for the compiled march along them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fe_lapjoint.march.system import ComplexArray, IndexArray, System
from lapjoint.compiled.by_reference import by_reference, in_c_order
from lapjoint.problem import FloatArray


@by_reference
class RampTables(NamedTuple):
    """A contact state with ``n`` modes, ``P`` stops at ``p`` places, ``H`` harmonic loads and ``R`` sampled forces.

    Of the modes ``o`` oscillate, ``e`` do not, and ``r`` are rigid-body modes; ``b`` terms are bounded, see
    `fe_lapjoint.march.envelope`: the modes as in `System.bounded`, the loads, and the rigid-body modes.
    """

    omega: FloatArray
    """Natural angular frequencies, rad/s, shape ``(n,)``."""
    damping_rate: FloatArray
    """zeta omega, 1/s, shape ``(n,)``."""
    compliance: FloatArray
    """1 / omega^2, s2, 0 for rigid-body modes, shape ``(n,)``."""
    constant: FloatArray
    """Modal force of the closed stops' gaps and of the step loads, kg^1/2 m/s2, shape ``(n,)``."""
    forces: FloatArray
    """Modal force for each unit of a sampled force, kg^-1/2, or kg^-1/2 m along the beam, shape ``(n, R)``."""
    which: IndexArray
    """The modes that oscillate, shape ``(o,)``."""
    others: IndexArray
    """The modes that do not oscillate, shape ``(e,)``."""
    rigid: IndexArray
    """The rigid-body modes, shape ``(r,)``."""
    rates: ComplexArray
    """Rates of the terms, 1/s: of the modes that oscillate, and of the loads; shape ``(o + H,)``."""
    swinging: FloatArray
    """Moduli of `rates` where the amplitude bounds the term, else 0, 1/s, shape ``(o + H,)``."""
    driven: FloatArray
    """Angular frequencies of the harmonic loads, rad/s, shape ``(H,)``."""
    phase: FloatArray
    """Phases of the harmonic loads, rad, shape ``(H,)``."""
    forced: ComplexArray
    """Complex amplitudes P of the modes under the harmonic loads, Im(P exp(i angle)), kg^1/2 m, shape ``(n, H)``."""
    places: FloatArray
    """Modes at the places, kg^-1/2, shape ``(p, n)``."""
    forced_places: ComplexArray
    """Complex amplitudes of the places under the harmonic loads, m, shape ``(p, H)``."""
    ringing: IndexArray
    """Modes that are bounded by one amplitude."""
    near: IndexArray
    """Modes that are nearly critical."""
    creeping: IndexArray
    """Modes that are bounded by two amplitudes."""
    slow: FloatArray
    """The lower rate of each creeping mode, 1/s."""
    fast: FloatArray
    """The higher rate of each creeping mode, 1/s."""
    shares: FloatArray
    """Moduli of the factor of each bounded term in the motion of the places, shape ``(p, b)``."""
    fading: FloatArray
    """Rates at which the bounds fall, 1/s, shape ``(b,)``."""
    place_of: IndexArray
    """Which place each stop is at, shape ``(P,)``."""
    orientation: FloatArray
    """+1 or -1, shape ``(P,)``; see `Model.orientation`."""
    offset: FloatArray
    """m, shape ``(P,)``; see `Model.offset`."""
    window: float
    """Longest time that one closed form is searched for, s."""
    spacing: float
    """The usual time between knots, s; 0 without one."""
    whole: ComplexArray
    """exp(rate spacing) of each term, shape ``(o + H,)``."""
    whole_areas: ComplexArray
    """The integral of exp(rate s) over `spacing`, s, shape ``(o + H,)``."""


def ramp_tables(system: System, orientation: FloatArray, offset: FloatArray, window: float) -> RampTables:
    """The tables of a contact state with sampled forces; signs and gaps ``(P,)`` as in `Model`; `window` in s."""
    assert system.ramps is not None
    spacing = system.ramps.ramps.block_at(0.0).spacing
    omega, H = system.omega, system.driven.size
    rates, rigid = system.rates_of_terms[:-1].copy(), np.flatnonzero(omega == 0)
    ringing, near, creeping = system.bounded
    bounded = ringing.size + near.size + 2 * creeping.size + H  # without the last term, of constant forces
    made = RampTables(
        omega=omega,
        damping_rate=system.damping_rate,
        compliance=1 / np.where(omega > 0, omega, np.inf) ** 2,
        constant=system.constant,
        forces=system.ramps.shares,
        which=system.which,
        others=np.flatnonzero(~system.oscillating),
        rigid=rigid,
        rates=rates,
        swinging=system.swinging[:-1].copy(),
        driven=system.driven,
        phase=system.phase,
        forced=system.amplitudes,
        places=system.places,
        forced_places=system.place_amplitudes,
        ringing=ringing,
        near=near,
        creeping=creeping,
        slow=system.creeping_rates[0],
        fast=system.creeping_rates[1],
        shares=np.concatenate([system.bounded_shares[:, :bounded], np.abs(system.places[:, rigid])], axis=1),
        fading=np.concatenate([system.fading[:bounded], np.zeros(rigid.size)]),
        place_of=system.place_of,
        orientation=orientation,
        offset=offset,
        window=window,
        spacing=spacing,
        whole=np.exp(rates * spacing),
        whole_areas=np.expm1(rates * spacing) / rates,
    )
    return in_c_order(made)

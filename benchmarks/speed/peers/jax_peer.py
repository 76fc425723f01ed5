"""JAX on the processor: `lax.scan` over dense matrices, compiled, in its own float."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.speed.inputs import SAMPLE_PERIOD_S, Recording
from benchmarks.speed.peers.matrices import ORDERS, P0, ROW, Q, R
from benchmarks.speed.peers.peer import Peer

jax.config.update("jax_platforms", "cpu")


def _turning(speed: Any) -> Any:
    angle = SAMPLE_PERIOD_S * speed[:, None] * jnp.asarray(ORDERS, jnp.float32)
    c, s = jnp.cos(angle), jnp.sin(angle)
    matrices = jnp.zeros((len(speed), 6, 6), jnp.float32)
    even, odd = np.arange(0, 6, 2), np.arange(1, 6, 2)
    matrices = matrices.at[:, even, even].set(c).at[:, odd, odd].set(c)
    return matrices.at[:, even, odd].set(s).at[:, odd, even].set(-s)


@jax.jit
def _filtered(torque: Any, speed: Any) -> Any:
    row = jnp.asarray(ROW[0], jnp.float32)
    added = jnp.asarray(Q, jnp.float32)
    noise = jnp.float32(R[0, 0])

    def step(carry: Any, sample: Any) -> Any:
        state, P = carry
        measured, turn = sample
        ripple = row @ state
        seen = P @ row
        gain = seen / (row @ seen + noise)
        state = turn @ (state + gain * (measured - ripple))
        P = turn @ (P - jnp.outer(gain, seen)) @ turn.T + added
        return (state, P), ripple

    start = (jnp.zeros(6, jnp.float32), jnp.asarray(P0, jnp.float32))
    return jax.lax.scan(step, start, (torque, _turning(speed)))[1]


def make(_case: str, recording: Recording) -> Peer:
    """Make the peer.

    Parameters
    ----------
    _case : str
        The published filter is the only one.
    recording : Recording
        Signals.

    Returns
    -------
    Peer
        Ready to run.
    """
    torque = jnp.asarray(recording.torque_Nm, jnp.float32)
    speed = jnp.asarray(recording.motor_speed_rad_s, jnp.float32)

    def run(samples: int) -> Any:
        return _filtered(torque[:samples], speed[:samples]).block_until_ready()

    return Peer(jax.__version__, run, np.asarray)

"""Steps of a stream of work in threads of their own, a few parts ahead or behind, and no more.

What arrays are computed with gives up the interpreter meanwhile: reading, filtering and writing go on
at the same time. Order stays, and what goes wrong in a thread is raised where its results are wanted.
"""

from __future__ import annotations

import contextlib
import threading
from queue import SimpleQueue
from typing import TYPE_CHECKING, Final, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

Part = TypeVar("Part")

#: Parts that wait between two steps: enough that neither waits for a moment of the other's.
MOST_WAITING: Final = 4


class _End:
    """Comes after the last part, with what went wrong."""

    def __init__(self, error: BaseException | None = None) -> None:
        self.error = error


def made_ahead(parts: Iterable[Part], *, most_waiting: int = MOST_WAITING) -> Iterator[Part]:
    """Let a thread make the next parts while the last ones are used.

    Parameters
    ----------
    parts : iterable
        What is made; the thread alone goes through it.
    most_waiting : int
        Parts that wait, and one more that is made already.

    Yields
    ------
    object
        The parts, in order.
    """
    made: SimpleQueue[Part | _End] = SimpleQueue()
    room = threading.Semaphore(most_waiting)
    given_up = threading.Event()

    def make() -> None:
        try:
            for part in parts:
                made.put(part)
                room.acquire()
                if given_up.is_set():
                    return
        except BaseException as error:  # noqa: BLE001 - raised where the parts are used
            made.put(_End(error))
        else:
            made.put(_End())

    maker = threading.Thread(target=make, name="ahead", daemon=True)
    maker.start()
    try:
        while not isinstance(part := made.get(), _End):
            room.release()
            yield part
        if part.error is not None:
            raise part.error
    finally:
        given_up.set()
        room.release()
        maker.join()


@contextlib.contextmanager
def done_behind(
    work: Callable[[Part], None], *, most_waiting: int = MOST_WAITING
) -> Iterator[Callable[[Part], None]]:
    """Let a thread work on parts while the next ones are made.

    All parts are worked on when the block ends. Where it ends with an exception, those that wait are
    left alone.

    Parameters
    ----------
    work : callable
        Takes one part after the other, in order.
    most_waiting : int
        Parts that wait or are worked on.

    Yields
    ------
    callable
        Hands a part to the thread; raises what went wrong with an earlier one.
    """
    waiting: SimpleQueue[Part | _End] = SimpleQueue()
    room = threading.Semaphore(most_waiting)
    given_up = threading.Event()
    errors: list[BaseException] = []

    def work_on_all() -> None:
        while not isinstance(part := waiting.get(), _End):
            if not given_up.is_set():
                try:
                    work(part)
                except BaseException as error:  # noqa: BLE001 - raised where the parts are made
                    errors.append(error)
                    given_up.set()
            room.release()

    def hand_over(part: Part) -> None:
        room.acquire()
        if errors:
            raise errors[0]
        waiting.put(part)

    worker = threading.Thread(target=work_on_all, name="behind", daemon=True)
    worker.start()
    try:
        yield hand_over
    except BaseException:
        given_up.set()
        raise
    finally:
        waiting.put(_End())
        worker.join()
    if errors:
        raise errors[0]

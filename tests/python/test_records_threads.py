"""Steps in threads of their own: order, bounds, and what goes wrong in them."""

import threading
import time
from itertools import count

import pytest

from strainwave.records.threads import MOST_WAITING, done_behind, made_ahead


class BrokenError(Exception):
    pass


def _none_are_left(before):
    deadline = time.monotonic() + 10.0
    while threading.active_count() > before:
        assert time.monotonic() < deadline
        time.sleep(0.001)


@pytest.fixture(autouse=True)
def _threads_end():
    before = threading.active_count()
    yield
    _none_are_left(before)


def test_parts_come_in_order_and_from_another_thread():
    makers = []

    def parts():
        for part in range(1000):
            makers.append(threading.current_thread())
            yield part

    assert list(made_ahead(parts())) == list(range(1000))
    assert set(makers).isdisjoint({threading.current_thread()})
    assert len(set(makers)) == 1
    assert list(made_ahead([])) == []


def test_only_a_few_parts_are_made_ahead():
    made = []
    ahead = made_ahead(made.append(part) or part for part in count())
    assert [next(ahead) for _ in range(10)] == list(range(10))
    deadline = time.monotonic() + 10.0
    while len(made) < 10 + MOST_WAITING and time.monotonic() < deadline:
        time.sleep(0.001)
    time.sleep(0.02)
    # Those that wait, and one that is made already but has no room.
    assert 10 + MOST_WAITING <= len(made) <= 11 + MOST_WAITING
    ahead.close()


def test_what_goes_wrong_ahead_comes_after_the_parts_before_it():
    def parts():
        yield 1
        yield 2
        raise BrokenError

    ahead = made_ahead(parts())
    assert [next(ahead), next(ahead)] == [1, 2]
    with pytest.raises(BrokenError):
        next(ahead)


def test_parts_are_worked_on_in_order_and_in_another_thread():
    done, workers = [], set()

    def work(part):
        done.append(part)
        workers.add(threading.current_thread())

    with done_behind(work) as put:
        for part in range(1000):
            put(part)
    assert done == list(range(1000))
    assert len(workers - {threading.current_thread()}) == len(workers) == 1


def test_no_more_than_a_few_parts_wait():
    go_on, handed = threading.Event(), []

    def hand_over(put):
        for part in range(20):
            put(part)
            handed.append(part)

    with done_behind(lambda _: go_on.wait()) as put:
        maker = threading.Thread(target=hand_over, args=(put,))
        maker.start()
        deadline = time.monotonic() + 10.0
        while len(handed) < MOST_WAITING and time.monotonic() < deadline:
            time.sleep(0.001)
        time.sleep(0.02)
        assert len(handed) == MOST_WAITING
        go_on.set()
        maker.join()
    assert len(handed) == 20


@pytest.mark.parametrize("parts", [1, 2, 100])
def test_what_goes_wrong_behind_ends_the_work(parts):
    done = []

    def work(part):
        if part == 0:
            raise BrokenError
        done.append(part)

    def work_on_all():
        with done_behind(work) as put:
            for part in range(parts):
                put(part)

    with pytest.raises(BrokenError):
        work_on_all()
    assert done == []


def test_an_exception_leaves_alone_what_waits():
    begun, go_on, done = threading.Event(), threading.Event(), []

    def work(part):
        begun.set()
        go_on.wait()
        done.append(part)

    def fail_later():
        with done_behind(work) as put:
            put(1)
            put(2)
            begun.wait()
            threading.Timer(0.05, go_on.set).start()
            raise BrokenError

    with pytest.raises(BrokenError):
        fail_later()
    assert done == [1]

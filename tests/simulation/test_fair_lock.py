"""Threads that share a simulation: order of the lock, and tasks left to its owner."""

import threading

import pytest

from atlas_drake.simulation.fair_lock import FairLock


def from_another_thread(call):
    """What a call in a thread of its own returns."""
    answers = []
    thread = threading.Thread(target=lambda: answers.append(call()))
    thread.start()
    thread.join(10.0)
    return answers[0]


def test_tasks_left_to_the_owner_run_in_order_before_release():
    lock, done = FairLock(), []
    with lock:
        for number in range(3):
            assert from_another_thread(
                lambda n=number: lock.leave(lambda: done.append(n))
            )
        assert done == []
    assert done == [0, 1, 2]
    assert not lock.leave(done.clear)


def test_tasks_that_leave_tasks_do_not_keep_the_lock():
    """Each task is followed by another, as from a thread that publishes in a loop."""
    lock, done = FairLock(), []

    def task():
        done.append(from_another_thread(lambda: lock.leave(task)))

    with lock:
        assert from_another_thread(lambda: lock.leave(task))
    assert done == [False]


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_an_interrupted_task_takes_neither_the_lock_nor_the_other_tasks(error):
    lock, done = FairLock(), []

    def interrupted():
        raise error

    def leave(task):
        assert from_another_thread(lambda: lock.leave(task))

    lock.__enter__()
    leave(interrupted)
    leave(lambda: done.append("after"))
    with pytest.raises(error):
        lock.__exit__()
    assert done == []

    def take():
        with lock:
            return True

    assert from_another_thread(take)
    assert done == ["after"]

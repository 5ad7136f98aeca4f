"""An interrupt that comes while kernels are loaded ends the run, whatever the compiler's library makes of it."""

import signal

import pytest

from sumo_reactive.driver.compilation import interrupts_kept


def swallowing():
    try:
        signal.raise_signal(signal.SIGINT)
    except KeyboardInterrupt:
        return


def turning_it_into_another():
    try:
        signal.raise_signal(signal.SIGINT)
    except KeyboardInterrupt as interrupt:
        raise SystemError("returned a result with an exception set") from interrupt


@pytest.mark.parametrize("loading", [swallowing, turning_it_into_another, lambda: signal.raise_signal(signal.SIGINT)])
def test_an_interrupt_is_never_lost(loading):
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt), interrupts_kept():
        loading()
    assert signal.getsignal(signal.SIGINT) is before


def test_a_request_that_its_handler_puts_off_is_none_yet():
    before = signal.signal(signal.SIGINT, lambda *_: None)
    try:
        with interrupts_kept():
            signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)


def test_an_error_without_an_interrupt_stays_itself():
    with pytest.raises(SystemError), interrupts_kept():
        raise SystemError


def test_a_process_that_ignores_interrupts_goes_on_ignoring_them():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with interrupts_kept():
            signal.raise_signal(signal.SIGINT)
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)

"""An interrupt that comes while kernels are loaded ends the run, and cuts no kernel in two."""

import signal

import pytest

from sumo_reactive.driver.compilation import between_kernels, interrupts_kept, kernel


def strike():
    signal.raise_signal(signal.SIGINT)


def swallowing():
    try:
        strike()
        between_kernels()
    except KeyboardInterrupt:
        return


def turning_it_into_another():
    try:
        strike()
        between_kernels()
    except KeyboardInterrupt as interrupt:
        raise SystemError("returned a result with an exception set") from interrupt


@pytest.mark.parametrize("loading", [strike, swallowing, turning_it_into_another])
def test_an_interrupt_is_never_lost(loading):
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt), interrupts_kept():
        loading()
    assert signal.getsignal(signal.SIGINT) is before


def test_an_interrupt_waits_for_the_kernel_that_is_loaded_and_comes_before_the_next():
    loaded = []
    with pytest.raises(KeyboardInterrupt), interrupts_kept():
        for number in range(3):
            between_kernels()
            strike()
            loaded.append(number)
    assert loaded == [0]


def test_whatever_swallows_an_interrupt_meets_it_again_before_the_next_kernel():
    with pytest.raises(KeyboardInterrupt), interrupts_kept():
        swallowing()
        with pytest.raises(KeyboardInterrupt):
            between_kernels()


def test_a_kernel_asks_for_interrupts_before_it_is_loaded():
    function = kernel(lambda value: value + 1.0)
    with pytest.raises(KeyboardInterrupt), interrupts_kept():
        strike()
        function(1.0)
    assert function.signatures == []


def test_a_request_that_its_handler_puts_off_is_none_yet():
    before = signal.signal(signal.SIGINT, lambda *_: None)
    try:
        with interrupts_kept():
            strike()
            between_kernels()
    finally:
        signal.signal(signal.SIGINT, before)


def test_an_error_without_an_interrupt_stays_itself():
    with pytest.raises(SystemError), interrupts_kept():
        raise SystemError


def test_a_process_that_ignores_interrupts_goes_on_ignoring_them():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with interrupts_kept():
            strike()
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)

"""Orders: when they are carried out, in which turn, and what becomes of those that SUMO refuses."""

import pickle

import libsumo
import pytest

from sumo_reactive.sumo.orders import AT_ONCE, SumoOrders, nothing

DONE: list[str] = []


def do(word: str) -> None:
    DONE.append(word)


def refuse(word: str) -> None:
    DONE.append(word)
    raise libsumo.TraCIException("refused")


@pytest.fixture(autouse=True)
def clean():
    DONE.clear()


def test_what_is_told_at_once_is_done_at_once_and_what_is_told_for_others_is_not():
    AT_ONCE(do, "now")
    AT_ONCE.elsewhere(do, "there")
    assert DONE == ["now"]


def test_orders_wait_and_are_carried_out_once():
    orders = SumoOrders()
    orders(do, "a")
    orders.elsewhere(do, "done already")
    assert DONE == []
    orders.carry_out()
    orders.carry_out()
    assert DONE == ["a"]


def test_those_of_all_processes_come_in_the_order_of_turns_and_of_one_ego_in_that_of_its_own():
    here, there = SumoOrders(), SumoOrders()
    for orders, number in ((here, 0), (there, 1), (here, 2), (there, 3)):
        for phase in (0, 3):
            orders.begin(phase, number)
            orders(do, f"{phase} {number} first")
            orders(do, f"{phase} {number} second")
    there.elsewhere(do, "3 3 third")
    sent = pickle.loads(pickle.dumps(there.for_others()))
    here.carry_out(sent)
    first = [f"{phase} {number} {nth}" for phase in (0, 3) for number in range(4) for nth in ("first", "second")]
    assert [*first, "3 3 third"] == DONE


def test_a_refusal_is_told_where_the_order_comes_from_and_is_without_effect_elsewhere():
    here, there, told = SumoOrders(), SumoOrders(), []
    here(refuse, "may fail", failed=lambda: told.append("failed"))
    here(do, "after")
    sent = pickle.loads(pickle.dumps(here.for_others()))
    here.carry_out()
    there.carry_out(sent)
    assert (told, DONE) == (["failed"], ["may fail", "after"] * 2)


def test_a_refusal_that_may_not_be_is_raised():
    orders = SumoOrders()
    orders(refuse, "must not fail")
    with pytest.raises(libsumo.TraCIException, match="refused"):
        orders.carry_out()
    AT_ONCE(refuse, "may fail", failed=nothing)
    with pytest.raises(libsumo.TraCIException, match="refused"):
        AT_ONCE(refuse, "must not fail")

"""Kills and stops at random moments."""

import os
import signal

from cases import Expected, Plan, fault

ENDING = {"kill": signal.SIGKILL, "term": signal.SIGTERM, "int": signal.SIGINT, "hup": signal.SIGHUP}


def moment(case, whole):
    """Seconds after the start: within a whole run, or a little later."""
    return case.numbers.random() * 1.1 * whole.seconds


def end(case, number, is_group):
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    at = moment(case, whole)

    def during(stages, seconds):
        if seconds < at:
            return False
        if is_group:
            os.killpg(stages[0].pid, number)
        elif stages[case.stage].poll() is None:
            stages[case.stage].send_signal(number)
        return True

    outcome = case.run(room, Plan(during=during), is_to_file)
    # A program of the group may end before the signal, by its neighbour's end.
    codes = [0, 3, 141] if is_group else [0]
    expected = Expected(
        case.stage, codes, [whole], signals=[number], momentary=number == signal.SIGKILL, is_read=not is_group
    )
    case.judge(outcome, expected, room, f"signal {number} after {at:.3f} s{', all' if is_group else ''}")


def register(name, number):
    @fault(name)
    def one(case):
        end(case, number, False)

    @fault(f"{name}-all", lambda job, stage: stage == 0)
    def everything(case):
        end(case, number, True)


for name, number in ENDING.items():
    register(name, number)


@fault("stop")
def stop(case):
    """A program that is stopped for a while goes on as if nothing had been."""
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    at, pause = moment(case, whole) / 1.1, case.numbers.uniform(0.02, 0.2)
    is_all = case.numbers.random() < 0.3
    stopped = []

    def during(stages, seconds):
        def send(number):
            chosen = stages if is_all else [stages[case.stage]]
            for stage in chosen:
                if stage.poll() is None:
                    stage.send_signal(number)
                    stopped.append(stage)

        if seconds >= at and not stopped:
            send(signal.SIGSTOP)
            return not stopped
        if stopped and seconds >= at + pause:
            send(signal.SIGCONT)
            return True
        return False

    outcome = case.run(room, Plan(during=during), is_to_file)
    case.judge(
        outcome,
        Expected(case.stage, [0], [whole]),
        room,
        f"stopped after {at:.3f} s for {pause:.3f} s",
        is_hit=bool(stopped),
    )

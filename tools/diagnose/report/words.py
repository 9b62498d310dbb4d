"""The first screen in sentences: verdict, what to do, how big, how sure, what it cannot be.

The verdict itself is decided elsewhere; here it is put in words, and every sentence is of the same probabilities.
"""

from __future__ import annotations

from collections.abc import Iterable

from ....model.core.faults import name_all
from ..answer.findings import APART, UNEXPLAINED, Answer, Cause, Findings, Hypothesis, Said
from . import phrases
from .phrases import name_of, names_of, sentence

#: Below this probability a cause that would be seen is ruled out.
RULED_OUT = 0.01
#: The tail of p where what is left is not noise.
ADEQUATE = 0.01
#: The other tail.
TOO_GOOD = 0.99
#: A scatter is told where it is so many times the card's, or as much less.
SCATTER = 1.5
#: Answers beside the first two are listed from this probability on.
LISTED = 0.05
#: Something is wrong where nothing has less than this, else it may be; hypotheses with as much are not excluded.
DOUBT = 0.1
#: Of several causes those act that have more.
LIKELY = 0.5
#: Longest list on the first screen.
MOST = 6
#: The same of lists of little weight.
FEW = 3
#: An answer of more causes than these is told cause by cause.
TOGETHER = 2
#: By how many standard deviations an experiment must raise a distance to be proposed.
RAISED = 0.5
#: Numbers of causes in words.
COUNTS = {2: "Two", 3: "Three", 4: "Four"}


def with_words(findings: Findings) -> Findings:
    """The findings with the sentences of the first screen, and with a warning for each contradiction in them."""
    said = Said(
        stands_out=phrases.list_residuals(findings.residuals, FEW),
        verdict=_verdict(findings),
        do=_do(findings),
        size=_size(findings),
        sure=_sure(findings),
        cannot_be=_cannot_be(findings),
        data=_data(findings),
    )
    wrong = [f"the result contradicts itself: {text}" for text in contradictions(findings)]
    warnings = tuple(dict.fromkeys((*wrong, *findings.warnings)))
    return findings.model_copy(update={"says": said, "warnings": warnings})


def contradictions(findings: Findings) -> list[str]:
    """Where verdict, alarm and probabilities do not agree; none of a sound decision."""
    total, quiet = sum(h.probability for h in findings.hypotheses), findings.verdict == "consistent"
    best = findings.answers[0].probability if findings.answers else 0.0
    known = {c.id for c in findings.causes}
    lost = findings.named - {UNEXPLAINED} - known
    alarm, explained = findings.test.p_any < findings.test.alpha, findings.verdict == "explained"
    p, nothing = phrases.p_value(findings.test.p_any), phrases.percent(findings.nothing)
    most = max([best, *(c.probability for c in findings.causes)])
    checks = [
        (total > 1 + 1e-6, f"the probabilities add up to {total:.3f}"),
        (quiet and alarm, f"nothing is wrong, yet {p} is an alarm"),
        (not quiet and not alarm, f"something is wrong, yet {p} is none"),
        (quiet and findings.nothing < 0.5, f"nothing is wrong, with {nothing}"),
        (not quiet and findings.nothing > 0.5, f"something is wrong, yet nothing has {nothing}"),
        (explained and len(findings.answers) != 1, "one answer explains it, and there are none or several"),
        (explained and best < 0.9, f"one answer explains it with {phrases.percent(best)}"),
        (quiet and bool(findings.answers), "nothing is wrong, and there is an answer"),
        (findings.nothing > 0.5 and most > 0.5, "nothing and something both have more than half"),
        (bool(lost), f"{', '.join(sorted(lost))} is named and not listed"),
    ]
    return [text for wrong, text in checks if wrong]


def _verdict(findings: Findings) -> str:
    """The verdict, and the values of the rig that calibration put far from those of its file."""
    off = phrases.calibration(findings, FEW)
    if findings.verdict != "consistent":
        return _claim(findings) + (f" Beside it the rig differs from its file: {off}." if off else "")
    said = "The data agree with the model within the stated accuracies."
    if off:
        said = f"The data agree with the model only with values far from those of its file: {off}."
    elif apart := phrases.as_filed(findings):
        said = f"The data agree with the model once it is calibrated; as filed it is off: {apart}."
    possible = [f"{names_of(h.causes)} ({phrases.percent(h.probability, h.mc_error)})" for h in _possible(findings)]
    return said + (f" Not excluded: {'; '.join(possible[:FEW])}." if possible else "")


def _possible(findings: Findings) -> list[Hypothesis]:
    """Hypotheses that a verdict without a cause does not exclude."""
    return [h for h in findings.hypotheses if h.causes and h.probability >= DOUBT]


def _claim(findings: Findings) -> str:
    """What is wrong."""
    answers, left = findings.answers, findings.remainder
    maybe = _maybe(findings)
    wrong = f"Something {'may be' if maybe else 'is'} wrong"
    shown = left.channels[:2] if left else ()
    where = " and ".join(f"{c.channel} ({phrases.with_unit(c.rms, c.unit, 2)})" for c in shown)
    seen = f", seen in {where}" if where else ""
    if findings.verdict == "unexplained" or not answers:
        chance = f" ({phrases.percent(left.probability, left.mc_error)})" if left else ""
        best = next((a for a in answers if a.causes != ((UNEXPLAINED,),)), None)
        closest = f" The closest known cause is {_probable(best)}." if best else ""
        return f"{wrong} that no cause of the library explains{chance}{seen}{maybe}.{closest}"
    more = left is not None and left.probability >= 0.5
    beside = f" Something that the library lacks acts beside {{}}{seen}." if more else ""
    if any(len(a.causes) > TOGETHER for a in answers):
        return _together(findings) + beside.format("them")
    if findings.verdict == "ambiguous":
        if len(answers) == 1:
            return f"{wrong}: {_probable(answers[0])}{maybe}."
        listed = [a for k, a in enumerate(answers) if k < MOST and (k < 2 or a.probability >= LISTED)]
        listed = list(answers) if len(answers) == len(listed) + 1 else listed
        rest = answers[len(listed) :]
        chance = phrases.percent(sum(a.probability for a in rest))
        unlikely = f"; or one of {len(rest)} less probable ones ({chance} together)" if rest else ""
        return f"{wrong}, and the data leave open what: {'; '.join(map(_probable, listed))}{unlikely}{maybe}."
    first = answers[0]
    leading = (findings.cause(group[0]) for group in first.causes)
    if limits := [c.id for c in leading if c is not None and c.parameters and c.parameters[0].at_bound]:
        return (
            f"{sentence(phrases.answer(first))} fits best ({phrases.percent(first.probability, first.mc_error)}), yet"
            f" only at the limit of the size that {names_of(limits)} can have: this is a pointer, not yet a finding."
        )
    n = len(first.causes)
    subject = f"{COUNTS.get(n, n)} causes together explain" if n > 1 else "One cause explains"
    return f"{subject} the data: {_probable(first)}.{beside.format('it')}{_left_open(findings, first)}"


def _together(findings: Findings) -> str:
    """What acts together: the causes that all answers share first, then those more likely than not, then others."""
    answers = [a for a in findings.answers if a.causes != ((UNEXPLAINED,),)]
    classes = {group[0]: set(group) for a in reversed(answers) for group in reversed(a.causes)}
    chances = {c: sum(one.probability for m in own if (one := findings.cause(m))) for c, own in classes.items()}

    def names(causes: Iterable[str]) -> str:
        ranked = sorted((c for c in causes if chances[c] >= LISTED), key=lambda c: -chances[c])
        return ", ".join(
            f"{names_of(sorted(classes[c], key=lambda m: (m != c, m)), 'or')} ({phrases.percent(chances[c])})"
            for c in ranked
        )

    shared = [c for c, own in classes.items() if all(any(own & set(group) for group in a.causes) for a in answers)]
    others = [c for c in classes if c not in shared]
    groups = {
        "In all likely answers": names(shared),
        "More likely than not": names(c for c in others if chances[c] >= LIKELY),
        "Perhaps": names(c for c in others if chances[c] < LIKELY),
    }
    maybe = _maybe(findings)
    said = f"Several causes {'may act' if maybe else 'act'} together{maybe}."
    return " ".join([said, *(f"{words}: {own}." for words, own in groups.items() if own)])


def _maybe(findings: Findings) -> str:
    """That nothing may be wrong, as the end of a sentence; empty where something is."""
    return f", or nothing is wrong ({phrases.percent(findings.nothing)})" if findings.nothing >= DOUBT else ""


def _left_open(findings: Findings, first: Answer) -> str:
    """Causes that may act beside those of an answer."""
    open_: dict[str, float] = {}
    for h in findings.hypotheses:
        if all(set(h.causes) & set(group) for group in first.causes):
            for cause in set(h.causes) - {c for group in first.causes for c in group}:
                open_[cause] = open_.get(cause, 0.0) + h.probability
    listed = sorted((c for c, p in open_.items() if p >= LISTED), key=lambda c: (-open_[c], c))
    told = ", ".join(f"{name_of(c)} ({phrases.percent(open_[c])})" for c in listed)
    return f" Whether others act as well is left open: {told}." if told else ""


def _probable(answer: Answer) -> str:
    return f"{phrases.answer(answer)} ({phrases.percent(answer.probability, answer.mc_error)})"


def _do(findings: Findings) -> str:
    """What to do now, the most pressing first."""
    steps = []
    if gross := findings.data_quality.gross:
        rows = ", ".join(f"{phrases.row(g)} ({name_all([g.channel, *g.instead], 'or')})" for g in gross[:MOST])
        steps.append(f"Check the reading{'s' if len(gross) > 1 else ''} in {rows} in your records.")
    if findings.verdict == "consistent":
        if findings.data_quality.nuisances:
            steps.append(
                "Check these values of the rig on the machine before its file is changed: the data alone do not"
                " tell a wrong value from a fault of the same part."
            )
        elif phrases.as_filed(findings):
            steps.append(
                "Give healthy data, too (--reference, --reference-logs): these alone do not tell a machine that is"
                " built otherwise from a fault that was there from their first on."
            )
        elif tests := _exposing(findings, (c for h in _possible(findings)[:1] for c in h.causes)):
            steps.append(f"To test what is not excluded: {tests}")
        else:
            steps.append("Nothing else needs doing." if steps else "Nothing needs doing.")
        return " ".join(steps)
    if warning := phrases.doubt(findings):
        steps.append(warning)
    first = findings.answers[0].causes if findings.answers else ()
    exposing = _exposing(findings, (c for group in first for c in group))
    if findings.verdict == "explained" and exposing:
        steps.append(f"To confirm it: {exposing}")
    elif (e := next(iter(findings.next_experiment), None)) and e.separation_after > e.separation_before + RAISED:
        before, after = phrases.sigma(e.separation_before), phrases.sigma(e.separation_after)
        steps.append(
            f"Measure next: {e.what or e.id}. That separates {names_of(e.separates)}: {before} standard"
            f" deviations now, {after} then."
        )
    elif exposing:
        steps.append(f"To test the most probable cause: {exposing}")
    else:
        steps.append("Look at the channel that deviates most before any part is changed.")
    return " ".join(steps)


def _exposing(findings: Findings, members: Iterable[str]) -> str:
    """The experiments that would show causes."""
    texts = [text for m in members if (c := findings.cause(m)) for text in c.exposes.rstrip(".").split("; ") if text]
    return "; ".join(dict.fromkeys(texts)) + "." if texts else ""


def _size(findings: Findings) -> str:
    """Effect in degC and W of the first answer, and the size of each of its causes."""
    if findings.verdict == "consistent":
        return ""
    said = []
    if findings.impact and findings.answers:
        first = findings.answers[0]
        which = f"if it is {phrases.answer(first)}: " if findings.verdict == "ambiguous" else ""
        if len(first.causes) > TOGETHER and len(findings.answers) > 1:
            which = "the likeliest of these answers: "
        powers = {i.what for i in findings.impact.values() if i.unit == "W"}
        felt = [i for i in findings.impact.values() if i.unit == "W" or i.what not in powers]
        effects = "; ".join(phrases.impact(i) for i in felt if phrases.number(max(map(abs, i.ci95)), 2) != "0")
        said += [f"{sentence(which + effects)}, on average."] if effects else []
    for answer in findings.answers[: 1 if findings.verdict != "ambiguous" else 2]:
        for group in answer.causes:
            sizes = []
            for c in (findings.cause(member) for member in group):
                if c is not None and c.parameters:
                    place = f" ({where})" if (where := phrases.where(c, findings.channels)) else ""
                    size = f"{phrases.meaning(c.parameters[0])} {phrases.estimate(c.parameters[0])}"
                    sizes.append(f"{name_of(c.id)}{place}: {size}")
            if sizes:
                said.append(f"{sentence('; or '.join(sizes))}.")
    return " ".join(dict.fromkeys(said))


def _sure(findings: Findings) -> str:
    test = findings.test
    said = [f"{sentence(phrases.chance(test.p_any))}; the alarm is set at {phrases.number(test.alpha, 2)}."]
    nothing = next((h for h in findings.hypotheses if not h.causes), None)
    if nothing is not None:
        said.append(f"Probability that nothing is wrong: {phrases.percent(nothing.probability, nothing.mc_error)}.")
    if test.p_adequacy is None:
        return " ".join(said)
    if test.p_adequacy < ADEQUATE:
        said.append(f"What is left is not noise ({phrases.p_value(test.p_adequacy)}): another effect is in the data.")
    elif test.p_adequacy > TOO_GOOD:
        said.append(
            f"What is left is smaller than the stated scatter ({phrases.p_value(test.p_adequacy)}): the accuracies"
            " of the card are too wide, or part of the effect is taken for noise."
        )
    else:
        odd = _inadequate(findings)
        but = f", but for {name_all(odd)}" if odd else ""
        said.append(f"What is left looks like noise ({phrases.p_value(test.p_adequacy)}){but}.")
    return " ".join(said)


def _inadequate(findings: Findings) -> list[str]:
    """Channels in which what is left is not noise, as seldom in all of them together as in one."""
    each = findings.data_quality.adequacy
    return [channel for channel, p in each.items() if p < ADEQUATE / len(each)]


def _cannot_be(findings: Findings) -> str:
    """Causes that would show and do not; those that these data cannot tell from the answer, or cannot show."""
    said = []
    named = findings.named
    blind = {i.cause for i in findings.invisible}
    out = [c.id for c in findings.causes if _ruled_out(findings, c) and c.id not in named | blind]
    if out:
        said.append(f"Found in 80 of 100 such campaigns at their usual size, and not here: {names_of(out, most=MOST)}.")
    judged = {i.cause for i in findings.isolability} - blind  # no scatter is
    faint = [c.id for c in findings.causes if c.id in judged and not _seen(c)]
    if faint and not named:
        said.append(f"At their usual size not found in 80 of 100: {names_of(faint, 'or', FEW)}.")
    still_open = {c.id for c in findings.causes if c.probability >= RULED_OUT} - named
    for group in findings.sets:
        first, *alike = group.causes
        others = [c for c in alike if c in still_open]
        if first in named and others and group.distance < APART:
            by_size = " but by how usual the sizes are" if findings.verdict == "explained" else ""
            said.append(f"These data cannot tell {name_of(first)} from {names_of(others, 'or')}{by_size}.")
    if findings.invisible:
        said.append(f"These data cannot show {names_of((i.cause for i in findings.invisible), 'or', FEW)}.")
    return " ".join(said)


def _seen(cause: Cause) -> bool:
    return cause.detectable is not None and cause.usual is not None and cause.detectable <= cause.usual


def _ruled_out(findings: Findings, cause: Cause) -> bool:
    alike = any(cause.id in s.causes and s.distance < APART for s in findings.sets)
    return _seen(cause) and not alike and cause.probability < RULED_OUT


def _data(findings: Findings) -> tuple[str, ...]:
    """What is to be known of data and rig before any cause."""
    quality = findings.data_quality
    said = [phrases.gross(g) for g in quality.gross]
    said += [phrases.scatter(v) for v in quality.variance if not 1 / SCATTER <= v.ratio <= SCATTER]
    odd, most = _inadequate(findings), 1 - (1 - TOO_GOOD) / max(len(quality.adequacy), 1)
    for channel, p in quality.adequacy.items():
        if channel in odd:
            said.append(f"What is left in {channel} is not noise ({phrases.p_value(p)}).")
        elif p > most:
            said.append(f"What is left in {channel} is smaller than its stated scatter ({phrases.p_value(p)}).")
    return tuple(said)

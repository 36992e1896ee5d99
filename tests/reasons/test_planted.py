"""The answer to a beginner's question about a planted bug has the right reason, line and words."""

import pytest
from planted import PLANTED, open_session, perform


@pytest.mark.parametrize("planted", PLANTED, ids=lambda planted: planted.name)
def test_the_answer_names_the_bug(planted):
    with open_session(planted) as session:
        perform(session, planted)
        ask = session.why_not if planted.kind == "why not" else session.why
        answer = ask(planted.ask, at=planted.at)
        assert answer.code == planted.code, str(answer)
        assert planted.line in answer.facts["lines"], str(answer)
        assert planted.says in str(answer), str(answer)

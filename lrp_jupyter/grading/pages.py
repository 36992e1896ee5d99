"""Pages of marks as HTML: one file each, which needs no other, is light or dark, and can be printed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from html import escape

_STYLE = """
:root{color-scheme:light dark;--ink:#1f2328;--faint:#59636e;--paper:#fff;--line:#d4d8de;--soft:#f3f5f7;
--good:#1a7f37;--bad:#b42318;--hint:#fff6dd}
@media (prefers-color-scheme:dark){:root{--ink:#e6e8eb;--faint:#9aa3af;--paper:#16191d;--line:#3d444d;
--soft:#1f242a;--good:#4ac26b;--bad:#ff8a80;--hint:#332b14}}
body{font:16px/1.5 system-ui,'Segoe UI',Roboto,'DejaVu Sans',sans-serif;color:var(--ink);
background:var(--paper);max-width:56rem;margin:2rem auto;padding:0 1rem}
h1{font-size:1.6rem;line-height:1.2;margin:0 0 .25rem}h2{font-size:1.2rem;margin:2rem 0 .25rem}
h3{font-size:1rem;margin:1.25rem 0 .25rem}p{margin:.4rem 0}.faint{color:var(--faint)}
.good{color:var(--good)}.bad{color:var(--bad)}code{font-family:ui-monospace,Consolas,monospace;font-size:.92em;
background:var(--soft);padding:.1em .3em;border-radius:3px}
.hint{background:var(--hint);border-left:4px solid #d9a400;padding:.5rem .8rem;border-radius:3px}
.wide{overflow-x:auto}table{border-collapse:collapse;margin:.5rem 0}
th,td{text-align:left;vertical-align:top;padding:.25rem .9rem .25rem 0;border-bottom:1px solid var(--line)}
th{font-weight:600;color:var(--faint)}td.number{font-variant-numeric:tabular-nums}
svg{max-width:100%;height:auto}ul{padding-left:1.2rem}
@media print{:root{--ink:#000;--faint:#444;--paper:#fff;--line:#bbb;--soft:#f3f3f3;--good:#060;--bad:#900;
--hint:#fff}body{margin:0;max-width:none;font-size:11pt}section{break-inside:avoid}.wide{overflow:visible}}
"""


def page(title: str, body: Iterable[str]) -> str:
    """Return a page with a title and a body of HTML."""
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        f"<h1>{escape(title)}</h1>\n" + "\n".join(body) + "\n</body>\n</html>\n"
    )


def words(text: str) -> str:
    """Return a sentence as HTML, with what is between backticks as code."""
    return re.sub(r"`([^`\n]+)`", r"<code>\1</code>", escape(text)).replace("\n", "<br>")


def paragraph(text: str, kind: str = "") -> str:
    """Return a paragraph of sentences; `kind` is a class of the style."""
    return f'<p class="{kind}">{words(text)}</p>' if kind else f"<p>{words(text)}</p>"


def table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table of cells that are HTML."""
    head = "".join(f'<th scope="col">{words(each)}</th>' for each in columns)
    lines = ("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    body = "".join(lines)
    return f'<div class="wide"><table><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table></div>'


def sign(passed: bool) -> str:
    """Return the sign for what passed or did not, which a colour alone does not tell."""
    return '<span class="good">✓</span>' if passed else '<span class="bad">✗</span>'

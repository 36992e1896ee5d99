/**
 * The steps of undo. What is typed in one go is one step, as usual. A change that comes from elsewhere (the
 * cell, a menu, the graph) is a step of its own, however soon after a letter it comes. What the kernel or another
 * view has changed is no step: it stays when the user undoes what was typed here.
 */

import { history, isolateHistory } from "@codemirror/commands";
import { EditorState, type Extension, Transaction } from "@codemirror/state";

const ELSEWHERE = /^$|^input\.(draw|fix|format)$/;

export const steps: Extension = [
  history(),
  EditorState.transactionExtender.of((transaction) =>
    transaction.docChanged &&
    !transaction.annotation(Transaction.remote) &&
    ELSEWHERE.test(transaction.annotation(Transaction.userEvent) ?? "")
      ? { annotations: isolateHistory.of("full") }
      : null,
  ),
];

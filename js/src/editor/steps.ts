/**
 * The steps of undo. What is typed in one go is one step, as usual. A change that comes from elsewhere (the
 * kernel, the cell, a menu, the graph) is a step of its own, however soon after a letter it comes.
 */

import { history, isolateHistory } from "@codemirror/commands";
import { EditorState, type Extension, Transaction } from "@codemirror/state";

const ELSEWHERE = /^$|^input\.(draw|fix|format)$/;

export const steps: Extension = [
  history(),
  EditorState.transactionExtender.of((transaction) =>
    transaction.docChanged && ELSEWHERE.test(transaction.annotation(Transaction.userEvent) ?? "")
      ? { annotations: isolateHistory.of("full") }
      : null,
  ),
];

/** The extension for Visual Studio Code: it starts `lrp language-server`, which knows everything else. */

import { execFile } from "node:child_process";
import { type ExtensionContext, window, workspace } from "vscode";
import {
  CloseAction,
  ErrorAction,
  LanguageClient,
  RevealOutputChannelOn,
  State,
} from "vscode-languageclient/node";

const INSTALL =
  'Install it with pip install "lrp-jupyter[editors]", or name the command in the setting lrp.command.';

let client: LanguageClient | null = null;

async function start(): Promise<void> {
  const [command = "", ...options] = workspace.getConfiguration("lrp").get<string[]>("command")!;
  const args = [...options, "language-server"];
  let isServing = false;
  const started = new LanguageClient(
    "lrp",
    "LRP",
    { command, args },
    {
      documentSelector: [{ language: "lrp" }],
      revealOutputChannelOn: RevealOutputChannelOn.Never,
      initializationFailedHandler: () => false,
      errorHandler: {
        error: () => ({ action: ErrorAction.Continue, handled: true }),
        closed: () => ({
          action: isServing ? CloseAction.Restart : CloseAction.DoNotRestart,
          handled: !isServing,
        }),
      },
    },
  );
  started.onDidChangeState(({ newState }) => {
    isServing = newState === State.Running;
  });
  client = started;
  try {
    await started.start();
  } catch {
    const why = await reason(command, args);
    await window.showErrorMessage(`Programs have colours only. ${why}`);
  }
}

/** Why the server does not start: what it prints when it is run without an editor. */
function reason(command: string, args: string[]): Promise<string> {
  return new Promise((resolve) => {
    const server = execFile(command, args, (_error, _output, said) =>
      resolve(said.trim() || `\`${[command, ...args].join(" ")}\` cannot be started. ${INSTALL}`),
    );
    server.stdin?.on("error", () => {}).end();
  });
}

async function restart(): Promise<void> {
  await deactivate();
  await start();
}

export async function activate(context: ExtensionContext): Promise<void> {
  context.subscriptions.push(
    workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("lrp.command")) void restart();
    }),
  );
  await start();
}

export async function deactivate(): Promise<void> {
  const started = client;
  client = null;
  if (started?.isRunning()) await started.stop();
}

/** The extension for Visual Studio Code: it starts `lrp language-server`, which knows everything else. */

import { type ExtensionContext, window, workspace } from "vscode";
import { LanguageClient } from "vscode-languageclient/node";

let client: LanguageClient | null = null;

async function start(): Promise<void> {
  const [command, ...options] = workspace.getConfiguration("lrp").get<string[]>("command")!;
  const started = new LanguageClient(
    "lrp",
    "LRP",
    { command: command!, args: [...options, "language-server"] },
    { documentSelector: [{ language: "lrp" }] },
  );
  client = started;
  try {
    await started.start();
  } catch {
    await window.showErrorMessage(
      `The command \`${[command, ...options].join(" ")}\` cannot be started, so programs have colours only. ` +
        'Install it with pip install "lrp-jupyter[editors]", or name it in the setting lrp.command.',
    );
  }
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

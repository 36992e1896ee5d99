/** What a person can do with programs: open one in the lab, and begin one. */

import type { JupyterFrontEndPlugin } from "@jupyterlab/application";
import { ICommandPalette } from "@jupyterlab/apputils";
import type { DocumentWidget } from "@jupyterlab/docregistry";
import { IDefaultFileBrowser, IFileBrowserFactory } from "@jupyterlab/filebrowser";
import { ILauncher } from "@jupyterlab/launcher";
import { IMainMenu } from "@jupyterlab/mainmenu";
import type { Contents } from "@jupyterlab/services";
import { CommandToolbarButton } from "@jupyterlab/ui-components";
import { LAB } from "./files";
import { programIcon } from "./icons";

const OPEN = "lrp:open-in-lab";
const NEW = "lrp:new-program";
const CATEGORY = "LRP";
const BEGINNING = `\
; A robot that turns away from what it touches.
; world: walls
(machine rover
  (event bump [robot.bumper.data])
  (state driving (running [robot.move(linear=0.2)]))
  (state turning (running [robot.move(angular=1.0)]))
  (on bump driving -> turning)
  (ontime 1500 turning -> driving))
(spawn rover driving)
`;

const isProgram = (path: string | undefined): path is string => /\.lrp$/.test(path ?? "");

export const commands: JupyterFrontEndPlugin<void> = {
  id: "lrp-jupyter:commands",
  description: "Open a program in the lab, or begin one.",
  autoStart: true,
  optional: [ICommandPalette, ILauncher, IMainMenu, IFileBrowserFactory, IDefaultFileBrowser],
  activate(
    { commands, contextMenu, docRegistry, serviceManager, shell },
    palette: ICommandPalette | null,
    launcher: ILauncher | null,
    menu: IMainMenu | null,
    browsers: IFileBrowserFactory | null,
    browser: IDefaultFileBrowser | null,
  ) {
    const open = (path: string) => commands.execute("docmanager:open", { path, factory: LAB });
    /** The programs that are selected in the browser of files, or the one in the tab in front. */
    const meant = (inBrowser: unknown): string[] => {
      const selected = [...(browsers?.tracker.currentWidget?.selectedItems() ?? [])];
      const current = shell.currentWidget as Partial<DocumentWidget> | null;
      const paths = inBrowser ? selected.map(({ path }) => path) : [current?.context?.path];
      return paths.filter(isProgram);
    };
    commands.addCommand(OPEN, {
      label: "Open in the Lab",
      caption: "Run this program in a lab of its own",
      icon: programIcon,
      isEnabled: ({ inBrowser }) => meant(inBrowser).length > 0,
      execute: ({ inBrowser }) => Promise.all(meant(inBrowser).map(open)),
    });
    commands.addCommand(NEW, {
      label: ({ isPalette }) => (isPalette ? "New LRP Program" : "LRP Program"),
      caption: "Create a program and open it in the lab",
      icon: programIcon,
      async execute({ cwd }) {
        const path = (cwd as string | undefined) ?? browser?.model.path ?? "";
        const made: Contents.IModel = await commands.execute("docmanager:new-untitled", {
          path,
          type: "file",
          ext: "lrp",
        });
        const file = { type: "file", format: "text", content: BEGINNING } as const;
        await serviceManager.contents.save(made.path, file);
        return open(made.path);
      },
    });
    const inBrowser = { inBrowser: true };
    contextMenu.addItem({
      command: OPEN,
      args: inBrowser,
      selector: '.jp-DirListing-item[data-file-type="lrp"]',
      rank: 1,
    });
    palette?.addItem({ command: OPEN, category: CATEGORY });
    palette?.addItem({ command: NEW, category: CATEGORY, args: { isPalette: true } });
    launcher?.add({ command: NEW, category: "Other", rank: 5 });
    menu?.fileMenu.newMenu.addGroup([{ command: NEW }], 30);
    docRegistry.addWidgetExtension("Editor", {
      createNew(widget: DocumentWidget, { path }) {
        if (!isProgram(path)) return;
        const button = new CommandToolbarButton({ commands, id: OPEN, label: "Open in the Lab" });
        button.addClass("lrp-open-in-lab");
        widget.toolbar.addItem("lrp-open-in-lab", button);
        return button;
      },
    });
  },
};

/** Programs and recordings as types of files, and the tabs in which they open. */

import { ILayoutRestorer, type JupyterFrontEndPlugin } from "@jupyterlab/application";
import { WidgetTracker } from "@jupyterlab/apputils";
import type { DocumentRegistry, DocumentWidget } from "@jupyterlab/docregistry";
import type { LabIcon } from "@jupyterlab/ui-components";
import { ProgramTab, RecordingTab, TabFactory } from "./documents";
import { programIcon, recordingIcon } from "./icons";
import { MIME } from "./language";
import type { LabTab } from "./tab";

export const LAB = "LRP Lab";
const RECORDING = "LRP Recording";

export const files: JupyterFrontEndPlugin<void> = {
  id: "lrp-jupyter:files",
  description: "Programs and recordings as files, which open in the lab.",
  autoStart: true,
  optional: [ILayoutRestorer],
  activate({ docRegistry, serviceManager }, restorer: ILayoutRestorer | null) {
    let isRestoring = restorer !== null;
    void restorer?.restored.then(() => {
      isRestoring = false;
    });
    const tracker = new WidgetTracker<DocumentWidget<LabTab>>({ namespace: "lrp" });
    docRegistry.addFileType({
      name: "lrp",
      displayName: "LRP program",
      extensions: [".lrp"],
      mimeTypes: [MIME],
      fileFormat: "text",
      icon: programIcon,
    });
    docRegistry.addFileType({
      name: "lrplog",
      displayName: "LRP recording",
      extensions: [".lrplog", ".lrplog.gz"],
      mimeTypes: ["application/x-lrplog"],
      fileFormat: "base64",
      icon: recordingIcon,
    });
    const add = (
      tab: typeof ProgramTab | typeof RecordingTab,
      icon: LabIcon,
      options: DocumentRegistry.IWidgetFactoryOptions,
    ) => {
      const factory = new TabFactory(tab, icon, serviceManager, () => isRestoring, options as never);
      factory.widgetCreated.connect((_, widget) => void tracker.add(widget));
      docRegistry.addWidgetFactory(factory as never); // its types are not exact about what is optional
    };
    add(ProgramTab, programIcon, { name: LAB, fileTypes: ["lrp"] });
    add(RecordingTab, recordingIcon, {
      name: RECORDING,
      fileTypes: ["lrplog"],
      defaultFor: ["lrplog"],
      modelName: "base64",
      readOnly: true,
    });
    void restorer?.restore(tracker, {
      command: "docmanager:open",
      args: ({ context, content }) => ({
        path: context.path,
        factory: content instanceof ProgramTab ? LAB : RECORDING,
      }),
      name: ({ context }) => context.path,
    });
  },
};

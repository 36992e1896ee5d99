// Run pytest on a newer Python, compiled to WebAssembly: `npm run test:python -- FOLDER TESTS…`, where
// FOLDER holds pytest and what the tests import. Programs as deeply nested as some tests make them need
// more stack than Node has by itself.
import { fileURLToPath } from "node:url";
import { loadPyodide } from "pyodide";

const [packages, ...parts] = process.argv.slice(2);
const folders = { "/packages": packages, "/project": fileURLToPath(new URL("../..", import.meta.url)) };

const { HYPOTHESIS_PROFILE = "same" } = process.env;
const python = await loadPyodide({ env: { HOME: "/", PYTHONDONTWRITEBYTECODE: "1", HYPOTHESIS_PROFILE } });
for (const [inside, outside] of Object.entries(folders)) {
  python.FS.mkdirTree(inside);
  python.mountNodeFS(inside, outside);
}
python.globals.set("parts", python.toPy(parts));
process.exitCode = python.runPython(`
import os, sys
sys.path[:0] = ["/packages", "/project"]
os.chdir("/project")
print("Python", sys.version)
import pytest
int(pytest.main(list(parts)))
`);

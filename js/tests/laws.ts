/** fast-check, which tries the same examples every time. */

import fc from "fast-check";

fc.configureGlobal({ seed: 1, numRuns: 300 });

export default fc;

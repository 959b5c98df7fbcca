// In node the module is read from the package's folder. `init()` is then done, so that one program serves both.
import { readFileSync } from "node:fs";
import { initSync } from "./ddl_forecast.js";

initSync({ module: readFileSync(new URL("./ddl_forecast_bg.wasm", import.meta.url)) });

export * from "./ddl_forecast.js";
export { default } from "./ddl_forecast.js";

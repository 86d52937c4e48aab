// As the program `palpate-replica`: node run.mjs MODULE CELLS TRIALS CONFIG...
import { readFileSync } from "node:fs";
import { basename } from "node:path";

const [module, cells, trials, ...configs] = process.argv.slice(2);
const { instance } = await WebAssembly.instantiate(readFileSync(module), {});
const { push, run, pull } = instance.exports;
for (const config of configs) {
  for (const byte of readFileSync(config)) push(byte);
  const answer = Buffer.alloc(run(Number(cells), Number(trials)) >>> 0);
  for (let place = answer.length - 1; place >= 0; place--) answer[place] = pull();
  process.stdout.write(`# ${basename(config, ".toml")}\n${answer}`);
}

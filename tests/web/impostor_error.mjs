// Prints the error of bakes as examples/impostors-three draws them, beside the mesh as three.js draws it:
//   node tests/web/impostor_error.mjs [--grid N] [--size PX] [--directions N] MODEL...      MODEL: knot, or a .glb file
// It needs the release build, scripts/setup-browser, and WEB_BIN and WEB_MODULES as tests/web/run sets them.
import { basename, join } from 'node:path';
import { parseArgs } from 'node:util';
import { hostSite, launch, open, write } from './harness.mjs';
import { bakeOf, hostPage, hostFiles } from './impostor_bench.mjs';

const { values, positionals } = parseArgs({ allowPositionals: true, options: {
  grid: { type: 'string', default: '8' }, size: { type: 'string', default: '2048' }, directions: { type: 'string', default: '24' }, radii: { type: 'string', default: '4' },
  light: { type: 'string', default: 'lit' }, cut: { type: 'boolean', default: false }, show: { type: 'string' } } });
const site = await hostSite(hostFiles(positionals));
site.put('/host.html', hostPage);
const browser = await launch();
for (const model of positionals) {
  const bake = bakeOf(model, ['--grid', values.grid, '--size', values.size]);
  site.put(`/baked/${bake.name}.json`, bake.json);
  for (const [file, bytes] of Object.entries(bake.pictures)) site.put(`/baked/${file}`, bytes);
  const page = await open(browser, `${site.origin}/host.html`);
  await page.waitForFunction(() => globalThis.measure);
  const found = await page.evaluate((o) => measure(o), {
    bake: `/baked/${bake.name}.json`, model: model === 'knot' ? 'knot' : `/models/${basename(model)}`, directions: Number(values.directions),
    radii: Number(values.radii), light: values.light, cut: values.cut, show: Boolean(values.show) });
  console.log(`${basename(model)}, ${values.light}, ${values.radii} r, ${values.grid} x ${values.grid} frames, ${found.texture_mib.toFixed(1)} MiB: ` +
    `${found.psnr.toFixed(1)} dB (worst ${found.worst.toFixed(1)}), IoU ${found.iou.toFixed(3)}`);
  if (values.show) for (const [i, name] of ['mesh', 'impostor'].entries()) write(join(values.show, `${bake.name}.${name}.rgba`), Buffer.from(found.shown[i]));
  if (page.problems.length) console.log(page.problems.join('\n'));
  await page.context().close();
}
process.exit(0);

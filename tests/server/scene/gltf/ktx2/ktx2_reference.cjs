// Decodes every level of every KTX2 file with the original transcoder in node: writes the pixels to
// OUT, and the table of their sums to standard output.
//   node ktx2_reference.cjs BASIS_DIR FILES OUT > reference.tsv
const fs = require('fs'), path = require('path'), crypto = require('crypto');
const [dir, files, out] = process.argv.slice(2);
fs.mkdirSync(out, { recursive: true });
fs.copyFileSync(dir + '/basis_transcoder.js', out + '/basis_transcoder.cjs');
fs.copyFileSync(dir + '/basis_transcoder.wasm', out + '/basis_transcoder.wasm');
const BASIS = require(path.resolve(out + '/basis_transcoder.cjs'));
BASIS().then((m) => {
  m.initializeBasis();
  for (const name of fs.readdirSync(files).filter((f) => f.endsWith('.ktx2')).sort()) {
    const f = new m.KTX2File(new Uint8Array(fs.readFileSync(files + '/' + name)));
    if (!f.isValid() || !f.startTranscoding()) throw name;
    for (let l = 0; l < f.getLevels(); l++) {
      const i = f.getImageLevelInfo(l, 0, 0);
      const d = new Uint8Array(f.getImageTranscodedSizeInBytes(l, 0, 0, 13));
      if (!f.transcodeImage(d, l, 0, 0, 13, 0, -1, -1)) throw name;
      fs.writeFileSync(`${out}/${name}.${l}.rgba`, d);
      console.log([name, l, i.origWidth, i.origHeight, crypto.createHash('sha256').update(d).digest('hex')].join('\t'));
    }
    f.close(); f.delete();
  }
});

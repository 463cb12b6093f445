// node list_stream.js FILE...: what host_sim/report/stream_decoder.js reads, in the lines of
// tests/ref/stream_decoder.py.
"use strict";
const fs = require("fs"), path = require("path");
const root = path.join(__dirname, "../..");
const {StreamDecoder} = require(path.join(root, "host_sim/report/stream_decoder.js"));
const tables = JSON.parse(fs.readFileSync(path.join(root, "docs/stream_tables.json"), "utf8"));

function hex(x) {
    const view = new DataView(new ArrayBuffer(4));
    view.setFloat32(0, x);
    return view.getUint32(0).toString(16).padStart(8, "0");
}
for (const file of process.argv.slice(2)) {
    const lines = [];
    const decoder = new StreamDecoder(tables, {
        run(h) { lines.push(`run ${h.run} stream ${h.streamId} base ${h.baseNs} sub ${h.subNs}`); },
        event(e) { lines.push(`event ${e.tNs} ${e.channel} ${e.value}`); },
        piece(p) {
            if (p.cubic) {
                lines.push(`cubic ${p.channel} ${p.axis} ${p.start} ${p.end} ${p.code} ${p.cubic.join(" ")}`);
                return;
            }
            const numbers = p.v.map((v, i) => `${v} ${p.s[i]} ${hex(p.rise[i])}`).join(" ");
            const anchor = p.rotates ? " " + p.anchor.map(hex).join(" ") : "";
            lines.push(`piece ${p.channel} ${p.axis} ${p.start} ${p.end} ${p.code} ${p.fresh ? 1 : 0} ${numbers}${anchor}`);
        },
    });
    const bytes = fs.readFileSync(file);
    for (let i = 0; i < bytes.length; i += 37) decoder.feed(bytes.subarray(i, i + 37));  // in parts
    decoder.feed(new Uint8Array(0), true);
    process.stdout.write(lines.join("\n") + "\n");
}

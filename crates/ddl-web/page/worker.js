// The forecaster, in a thread of its own: the page stays responsive. The first message brings the module (gzip in
// base64), every other one a file; each is answered in turn.

async function begin(packed) {
  const text = atob(packed);
  const bytes = new Uint8Array(text.length);
  for (let at = 0; at < bytes.length; at += 1) bytes[at] = text.charCodeAt(at);
  const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  await wasm_bindgen({ module_or_path: await new Response(unpacked).arrayBuffer() });
  // Loads the model.
  new wasm_bindgen.Live().free();
}

let ready;

self.onmessage = async ({ data }) => {
  try {
    if (data.packed) {
      ready = begin(data.packed);
      await ready;
      postMessage({});
      return;
    }
    await ready;
    const start = performance.now();
    const view = wasm_bindgen.view(data.name, data.bytes, data.options);
    postMessage({ id: data.id, view, seconds: (performance.now() - start) / 1000 });
  } catch (error) {
    // After a trap, also of the stack, the module is in no state to go on.
    const broken = error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
    postMessage({ id: data.id, error: error.message, broken });
  }
};

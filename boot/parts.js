// Instantiates a part of the page. A server that does not know what wasm is still serves it.
async function instantiatePart(fetched, imports) {
  const response = await fetched;
  if (!response.ok) {
    throw new Error(`${response.url}: ${response.status}`);
  }
  return response.headers.get("Content-Type") === "application/wasm"
    ? WebAssembly.instantiateStreaming(response, imports)
    : WebAssembly.instantiate(await response.arrayBuffer(), imports);
}

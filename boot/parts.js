// Instantiates a lazy part of the page. Servers that do not send the MIME type of wasm work too.
async function instantiatePart(fetched, imports) {
  const response = await fetched;
  if (!response.ok) {
    throw new Error(`${response.url}: ${response.status}`);
  }
  return response.headers.get("Content-Type") === "application/wasm"
    ? WebAssembly.instantiateStreaming(response, imports)
    : WebAssembly.instantiate(await response.arrayBuffer(), imports);
}

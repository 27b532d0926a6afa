"""Files beside a module of WebAssembly: its interface in JavaScript and TypeScript, and a page."""

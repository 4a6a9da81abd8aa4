// Images as the page carries them -> numbers.

/** The 65,536 values of a half float. */
const halves = (() => {
  const values = new Float32Array(65536);
  for (let bits = 0; bits < 65536; ++bits) {
    const sign = bits & 0x8000 ? -1 : 1, exponent = (bits >> 10) & 31, fraction = bits & 1023;
    if (exponent === 31) values[bits] = fraction ? NaN : sign * Infinity;
    else values[bits] = sign * (exponent === 0 ? fraction * 2 ** -24 : (1 + fraction / 1024) * 2 ** (exponent - 15));
  }
  return values;
})();

/** base64 of zlib of byte planes, low bytes first -> `count` Float32Arrays of n values, times `unit`. */
async function decodePlanes(packed, count, n) {
  const bytes = Uint8Array.from(atob(packed.half), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const raw = new Uint8Array(await new Response(stream).arrayBuffer());
  return Array.from({ length: count }, (_, c) => {
    const plane = new Float32Array(n), low = 2 * c * n, high = low + n;
    for (let i = 0; i < n; ++i) plane[i] = packed.unit * halves[raw[low + i] | (raw[high + i] << 8)];
    return plane;
  });
}

/** {width, height, scale, x0, y0, x1, y1, planes: [R, G, B], cost?, samples?, noise?, error?}; planes are row-major. */
async function decodeImage(image) {
  const n = image.width * image.height;
  const out = { width: image.width, height: image.height, scale: image.scale };
  for (const edge of ["x0", "y0", "x1", "y1"]) out[edge] = image[edge];
  out.planes = await decodePlanes(image, 3, n);
  for (const [name, layer] of Object.entries(image.layers || {})) [out[name]] = await decodePlanes(layer, 1, n);
  return out;
}

/** Relative squared error of pixel i, channels averaged: what relMSE averages. */
function pixelError(image, reference, i) {
  let sum = 0;
  for (let c = 0; c < 3; ++c) {
    const r = reference.planes[c][i], d = image.planes[c][i] - r;
    sum += (d * d) / (r * r + 1e-2);
  }
  return sum / 3;
}

/**
 * A plane of pixelError, made once per image. One shown smaller brings its own, averaged after the error was taken at
 * full resolution: averaged colours have scale² less noise.
 */
function errorPlane(image, reference) {
  if (!image.error) image.error = Float32Array.from({ length: image.width * image.height }, (_, i) => pixelError(image, reference, i));
  return image.error;
}

/**
 * Mean of a plane over the pixels [x0,x1) × [y0,y1) of the full image. A pixel of the plane counts for as many as it is the
 * mean of: at the right and bottom edge fewer than elsewhere.
 */
function meanOver(image, plane, [x0, y0, x1, y1]) {
  const s = image.scale, left = Math.floor((x0 - image.x0) / s), right = Math.ceil((x1 - image.x0) / s);
  const across = (i, origin, end) => Math.min(s, end - origin - i * s);
  let sum = 0, count = 0;
  for (let y = Math.floor((y0 - image.y0) / s); y < Math.ceil((y1 - image.y0) / s); ++y)
    for (let x = left; x < right; ++x) {
      const pixels = across(x, image.x0, image.x1) * across(y, image.y0, image.y1);
      sum += pixels * plane[y * image.width + x];
      count += pixels;
    }
  return count ? sum / count : NaN;
}

// SPDX-License-Identifier: MIT
// The relief in WebGL2, textured with the picture.
// The heights of an object are a texture of floats. The vertex shader reads its height by the
// number of the vertex, so a new relief is one upload, and the triangles of a grid are made once
// for each size. Samples outside the mask lie on the picture's plane: they close the steep sides of
// the object. The picture itself is a grid of 2 x 2 samples.

const kOutside_mm = -1000;  // marks samples outside the mask
const kPlaneShade = 0.6;    // chosen: the picture is darker than the relief

const kVertex = `#version 300 es
precision highp float;
uniform highp sampler2D heights;
uniform ivec2 grid;
uniform vec4 place;     // first sample and step, px of the picture
uniform vec4 picture;   // size, px; mm per px
uniform vec4 turned;    // cos and sin of yaw and of pitch
uniform vec4 lens;      // zoom and shift of the screen
uniform vec3 eye;       // distance, middle, base: mm
out vec2 uv;
out vec3 normal;
out float inside;
float sampleHeight(ivec2 at) {
  return texelFetch(heights, clamp(at, ivec2(0), grid - 1), 0).r;
}
float findSlope(ivec2 at, ivec2 step) {
  return max(sampleHeight(at - step), 0.0) - max(sampleHeight(at + step), 0.0);
}
void main() {
  ivec2 at = ivec2(gl_VertexID % grid.x, gl_VertexID / grid.x);
  float height = sampleHeight(at);
  inside = height > -900.0 ? 1.0 : 0.0;
  vec2 px = place.xy + vec2(at) * place.zw;
  uv = px / picture.xy;
  vec2 mm = vec2(px.x - 0.5 * picture.x, 0.5 * picture.y - px.y) * picture.zw;
  vec2 slope = vec2(findSlope(at, ivec2(1, 0)), -findSlope(at, ivec2(0, 1)));
  normal = vec3(slope / (2.0 * place.zw * picture.zw), 1.0);
  vec2 a = vec2(turned.x * mm.x - turned.y * mm.y, turned.y * mm.x + turned.x * mm.y);
  float z = max(height, 0.0) + eye.z - eye.y;
  float w = 1.0 - (z * turned.z - a.y * turned.w) / eye.x;
  vec2 seen = vec2(a.x, a.y * turned.z + z * turned.w);
  gl_Position = vec4(seen * lens.xy + lens.zw * w, 1.35 * w - 0.7, w);  // depth of w from 0.3 to 2
}`;

const kFragment = `#version 300 es
precision highp float;
uniform sampler2D colours;
uniform float shade;
in vec2 uv;
in vec3 normal;
in float inside;
out vec4 colour;
void main() {
  if (inside < 0.01) discard;
  float light = 0.45 + 0.75 * max(0.0, dot(normalize(normal), vec3(-0.47, 0.57, 0.67)));
  colour = vec4(texture(colours, uv).rgb * mix(light, shade, step(0.0, shade)), 1.0);
}`;

function buildProgram(gl) {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, kVertex], [gl.FRAGMENT_SHADER, kFragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error('WebGL2: ' + gl.getProgramInfoLog(program));
  return program;
}

function makeTexture(gl, filter) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  for (const name of ['TEXTURE_MIN_FILTER', 'TEXTURE_MAG_FILTER'])
    gl.texParameteri(gl.TEXTURE_2D, gl[name], filter);
  for (const name of ['TEXTURE_WRAP_S', 'TEXTURE_WRAP_T'])
    gl.texParameteri(gl.TEXTURE_2D, gl[name], gl.CLAMP_TO_EDGE);
  return texture;
}

/// Returns the triangles of a grid.
function makeTriangles(columns, rows) {
  const indices = new Uint32Array(6 * (columns - 1) * (rows - 1));
  let next = 0;
  for (let row = 0; row + 1 < rows; ++row) {
    for (let column = 0; column + 1 < columns; ++column) {
      const a = row * columns + column, b = a + columns;
      for (const index of [a, a + 1, b, a + 1, b + 1, b]) indices[next++] = index;
    }
  }
  return indices;
}

export class ReliefRenderer {
  /// Throws Error if the browser has no WebGL2.
  constructor(canvas) {
    const gl = canvas.getContext('webgl2', {antialias: true});
    if (!gl) throw new Error('this browser has no WebGL2');
    this.gl = gl;
    this.restore();
  }

  /// Makes the parts of the context, at first and after its loss.
  restore() {
    const gl = this.gl;
    this.program = buildProgram(gl);
    this.uniforms = {};
    for (const name
             of ['heights', 'grid', 'place', 'picture', 'turned', 'lens', 'eye', 'colours',
                 'shade'])
      this.uniforms[name] = gl.getUniformLocation(this.program, name);
    gl.bindVertexArray(gl.createVertexArray());
    this.colours = makeTexture(gl, gl.LINEAR);
    this.grids = new Map();
    this.objects = [];
    this.textures = [];
    this.plane = {columns: 2, rows: 2, texture: makeTexture(gl, gl.NEAREST)};
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32F, 2, 2, 0, gl.RED, gl.FLOAT, new Float32Array(4));
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(0.094, 0.102, 0.11, 1);
    this.hasPicture = false;
  }

  setPicture(bitmap) {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, this.colours);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    this.hasPicture = true;
  }

  /// Uploads the heights of all objects.
  setReliefs(objects) {
    const gl = this.gl;
    this.objects = objects.map((object, i) => {
      const texture = this.textures[i] ??= makeTexture(gl, gl.NEAREST);
      const count = object.columns * object.rows;
      if (!(this.scratch?.length >= count)) this.scratch = new Float32Array(count);
      for (let k = 0; k < count; ++k) {
        const height_mm = object.heights[k];
        this.scratch[k] = height_mm >= kOutside_mm ? height_mm : kOutside_mm;  // also NaN
      }
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texImage2D(
          gl.TEXTURE_2D, 0, gl.R32F, object.columns, object.rows, 0, gl.RED, gl.FLOAT,
          this.scratch);
      return {...object, heights: null, texture};
    });
  }

  useTriangles({columns, rows}) {
    const gl = this.gl;
    const name = `${columns}x${rows}`;
    let grid = this.grids.get(name);
    if (!grid) {
      if (this.grids.size > 32) {  // objects change their size: make them anew
        for (const {buffer} of this.grids.values()) gl.deleteBuffer(buffer);
        this.grids.clear();
      }
      const indices = makeTriangles(columns, rows);
      grid = {buffer: gl.createBuffer(), count: indices.length};
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, grid.buffer);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
      this.grids.set(name, grid);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, grid.buffer);
    return grid.count;
  }

  drawGrid(object, x, y, stepX, stepY, base_mm, shade, camera) {
    const gl = this.gl, at = this.uniforms;
    const count = this.useTriangles(object);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, object.texture);
    gl.activeTexture(gl.TEXTURE0);
    gl.uniform2i(at.grid, object.columns, object.rows);
    gl.uniform4f(at.place, x, y, stepX, stepY);
    gl.uniform3f(at.eye, camera.eye_mm, camera.middle_mm, base_mm);
    gl.uniform1f(at.shade, shade);
    gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0);
  }

  draw(stream, [sx, sy], camera) {
    const gl = this.gl, at = this.uniforms;
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!this.hasPicture) return;
    gl.useProgram(this.program);
    gl.uniform1i(at.colours, 0);
    gl.uniform1i(at.heights, 1);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.colours);
    gl.uniform4f(at.picture, stream.width_px, stream.height_px, sx, sy);
    gl.uniform4f(at.turned, ...camera.turned);
    gl.uniform4f(
        at.lens, 2 * camera.zoom / camera.width_px, 2 * camera.zoom / camera.height_px,
        2 * camera.left / camera.width_px - 1, 1 - 2 * camera.top / camera.height_px);
    this.drawGrid(this.plane, 0, 0, stream.width_px, stream.height_px, -0.2, kPlaneShade, camera);
    for (const object of this.objects) {
      if (object.columns > 1 && object.rows > 1)
        this.drawGrid(
            object, object.u + 0.5, object.v + 0.5, object.step, object.step, 0, -1, camera);
    }
  }
}

// gl.js: spheres as shaded discs with their true depth (WebGL 2), for both pages.
"use strict";
// sphere: x, y, z, radius; kind: the colour, 65536 red + 256 green + blue
const SPHERE = [
    `#version 300 es
in vec4 sphere; in float kind; uniform mat4 view, lens; uniform float height;
out vec3 centre; out float radius; out vec3 tint;
void main() {
    vec4 at = view * vec4(sphere.xyz, 1.0);
    centre = at.xyz, radius = sphere.w;
    tint = vec3(floor(kind / 65536.0), mod(floor(kind / 256.0), 256.0), mod(kind, 256.0)) / 255.0;
    gl_Position = lens * at;
    gl_PointSize = 1.08 * height * lens[1][1] * radius / gl_Position.w;
}`,
    `#version 300 es
precision highp float;
in vec3 centre; in float radius; in vec3 tint; uniform mat4 lens; out vec4 pixel;
void main() {
    vec2 p = 1.08 * (2.0 * gl_PointCoord - 1.0) * vec2(1.0, -1.0);
    float d = dot(p, p);
    if (d > 1.0) discard;
    vec3 n = vec3(p, sqrt(1.0 - d)), at = centre + radius * n;
    vec4 clip = lens * vec4(at, 1.0);
    gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
    float light = max(dot(n, normalize(vec3(-0.4, 0.75, 0.6))), 0.0);
    float shine = pow(max(dot(n, normalize(vec3(-0.2, 0.4, 0.9))), 0.0), 30.0);
    pixel = vec4(tint * (0.28 + 0.75 * light) + 0.25 * shine, 1.0);
}`
];
function linked(gl, [vertex, fragment]) {
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, source), gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    return program;
}

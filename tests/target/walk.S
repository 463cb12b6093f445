/* Functions whose deepest stack and dearest path are known by reading them: tests/target/walk.py */
    .syntax unified
    .thumb
    .macro function name
    .section .text.\name, "ax"
    .global \name
    .type \name, %function
    .thumb_func
\name:
    .endm

function leaf                   /* 8 bytes, 3 instructions */
    push {r4, lr}
    nop
    pop {r4, pc}

function nested                 /* 4 + 24 + 8 bytes, 5 + 3 instructions */
    push {lr}
    sub sp, #24
    bl leaf
    add sp, #24
    pop {pc}

function early                  /* a return by condition: 3 instructions, or 6 with the loop below once */
    cmp r0, #0
    it eq
    bxeq lr
    nop
    nop
    bx lr

function detour                 /* a call by condition: 4 instructions, 3 more with the call; 4 + 8 bytes */
    push {lr}
    cmp r0, #0
    it ne
    blne leaf
    pop {pc}

function rounds                 /* 2 + 3 a round + 1 */
    movs r2, #0
    nop
1:  adds r2, #1
    cmp r2, r0
    bne 1b
    bx lr

function tail                   /* ends in another function: 8 bytes before, 8 after, never both at once */
    push {r4, lr}
    pop {r4, lr}
    b leaf

function winding                /* calls itself */
    push {lr}
    bl winding
    pop {pc}

function blind                  /* calls what cannot be known */
    push {lr}
    blx r3
    pop {pc}

function astray                 /* moves the stack by what cannot be known */
    sub sp, sp, r0
    bx lr

function fused
    vfma.f32 s0, s1, s2
    bx lr

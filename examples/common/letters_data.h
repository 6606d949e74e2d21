/* letters_data.h: outlines of letters, digits and signs, for letters.h. Written by scripts/letters from DejaVu
   Sans 2.37.

   The outlines are those of the DejaVu fonts, https://dejavu-fonts.github.io, whose changes to Bitstream Vera are in
   the public domain. Their licence:

   Copyright (c) 2003 by Bitstream, Inc. All Rights Reserved. Bitstream Vera is a trademark of Bitstream, Inc.

   Permission is hereby granted, free of charge, to any person obtaining a copy of the fonts accompanying this
   license ("Fonts") and associated documentation files (the "Font Software"), to reproduce and distribute the Font
   Software, including without limitation the rights to use, copy, merge, publish, distribute, and/or sell copies
   of the Font Software, and to permit persons to whom the Font Software is furnished to do so, subject to the
   following conditions:

   The above copyright and trademark notices and this permission notice shall be included in all copies of one or
   more of the Font Software typefaces.

   The Font Software may be modified, altered, or added to, and in particular the designs of glyphs or characters
   in the Fonts may be modified and additional glyphs or characters may be added to the Fonts, only if the fonts
   are renamed to names not containing either the words "Bitstream" or the word "Vera".

   This License becomes null and void to the extent applicable to Fonts or Font Software that has been modified and
   is distributed under the "Bitstream Vera" names.

   The Font Software may be sold as part of a larger software package but no copy of one or more of the Font
   Software typefaces may be sold by itself.

   THE FONT SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT
   LIMITED TO ANY WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT OF COPYRIGHT,
   PATENT, TRADEMARK, OR OTHER RIGHT. IN NO EVENT SHALL BITSTREAM OR THE GNOME FOUNDATION BE LIABLE FOR ANY CLAIM,
   DAMAGES OR OTHER LIABILITY, INCLUDING ANY GENERAL, SPECIAL, INDIRECT, INCIDENTAL, OR CONSEQUENTIAL DAMAGES,
   WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM, OUT OF THE USE OR INABILITY TO USE THE FONT
   SOFTWARE OR FROM OTHER DEALINGS IN THE FONT SOFTWARE.

   Except as contained in this notice, the names of Gnome, the Gnome Foundation, and Bitstream Inc., shall not be
   used in advertising or otherwise to promote the sale, use or other dealings in this Font Software without prior
   written authorization from the Gnome Foundation or Bitstream Inc., respectively. For further information,
   contact: fonts at gnome dot org. */
#ifndef LETTERS_DATA_H
#define LETTERS_DATA_H

/* Coordinates in units of which 1024 are the size of the font (the height of a capital: 746), x to the right, y up from
   the line. An outline is a list of contours, each after a space: points of a quadratic spline, of four characters
   each. With d(c) the place of c in letters_digits, the first two are 90 d(1) + d(2) = 2 (x + 400) + (1 on the curve, 0
   off it), the last two 90 d(3) + d(4) = y + 400. */
enum { LETTERS_CAPITAL = 746, LETTERS_BASE = 90, LETTERS_SHIFT = 400 };

static const char letters_digits[] =
    "#$%&'()*+,-./0123456789:;<=>@ABCDEFGHIJKLMNOPQRSTUVWXYZ[]^_`abcdefghijklmnopqrstuvwxyz{|}~";

/* clang-format off */

/* By character: its number in Unicode, the way to the next letter, the outline. In ascending order. */
static const struct {
    unsigned code;
    int advance;
    const char *outline;
} letters_table[] = {
    {32, 326,
     ""},
    {33, 410,
     " /A(r1Y(r1Y'L/A'L /A/g1Y/g1Y,,1E*-/W*-/A,,"},
    {34, 471,
     " /~/g/~,`.*,`.*/g 42/g42,`2>,`2>/g"},
    {35, 858,
     " 7U,L4>,L3E*Z6[*Z 5r/[4d-@7z-@9./[:v/[9j-@=8-@=8,L9A,L8I*Z;z*Z;z)h7~)h6p'L5('L64)h2x)h1l'L/~'L10)h-`)h-`*Z1W*Z"
     "2Q,L.x,L.x-@2x-@4*/["},
    {36, 652,
     " 3Y%k2O%k2O'L1='M.{'e-l'{-l({.w(Z17(92O(82O*j0%*|-k+x-l,i-k-a05.e2O.k2O0+3Y0+3Y.m4Z.k6V.Z7O.M7O-P6V-e4Z-}3Y.#3"
     "Y+]6-+J8N*J8O)V8N(]5{'T3Y'M 2O+f2O.#13-y/o-B/p,q/o,F1++q 3Y*`3Y(95#(C6J({6K)M6J)z5'*S"},
    {37, 973,
     " <K++;N++:F*;:G)T:F(o;N'~<K'~=F'~>N(o>O)T>N*;=F++ <K+m>5+mA9*XA:)TA9(Q>3'=<K'=:_'=8Z(Q8[)T8Z*X:a+m 0|/30%/3.w."
     "D.x-^.w,v0#,*0|,*1y,*3',v3(-^3'.D1y/3 ;$/u<l/u2I'=0^'= 0|/u2g/u4o.a4p-^4o,X2g+F0|+F/5+F-/,Y-0-^-/.a/7/u"},
    {38, 798,
     " 1K+w0J+M/N*V/O*)/N);1o(33[(34_(36R(T7A(u 3$,T8`)_9=*/:%+;:,+u<2+u<%+1:s)g9r)%<z'L:0'L8W(;7H'j4s'=3I'=0g'=-@(n"
     "-A*#-@*e.o+|0>,R/i,s/7-V/8-u/7.m1a/u3f/u4_/u6N/c7K/P7K.O6N.g4c/$3z/$2k/$1@.H1A-w1@-]1}-'"},
    {39, 282,
     " /~/g/~,`.*,`.*/g"},
    {40, 400,
     " 2|0*1L.m0%,>0&+%0%)g1N'72|%z14%z/P'9-q)k-r+%-q,:/P.j140*"},
    {41, 400,
     " -f0*/Q0*11.j2o,:2p+%2o)k11'9/Q%z-f%z/3'70_)g0`+%0_,>/3.m"},
    {42, 512,
     " 6[.F2[-=6[,65z+a26,m26*d0|*d0|,m-8+a,W,60W-=,W.F-8.x0|-m0|/u26/u26-m5z.x"},
    {43, 858,
     " 6E.X6E+P<W+P<W*T6E*T6E'L4Q'L4Q*T.>*T.>+P4Q+P4Q.X"},
    {44, 326,
     " .W(r0x(r0x'v/,&.-`&..W'v"},
    {45, 370,
     " -$+%3$+%3$*--$*-"},
    {46, 326,
     " .C(r0b(r0b'L.C'L"},
    {47, 345,
     " 1b/g3W/g-l&G+v&G"},
    {48, 652,
     " 30/#1H/#/_-=/`+X/_)t1H(330(34s(36Z)t6[+X6Z-=4s/# 30/u5w/u8s-c8t+X8s)P5w'=30'=0B'=-H)P-I+X-H-c0B/u"},
    {49, 652,
     " .f(G2G(G2G.e.G.@.G/B2E/g4[/g4[(G8<(G8<'L.f'L"},
    {50, 652,
     " 0:(G8,(G8,'L-W'L-W(G.o)'39+<3n+Z4u,55i-'5j-L5i.-3u.z2I.z1D.z/#.X-b.5-b/B/%/[1F/u2E/u4y/u8#.Z8$-S8#-$77,+68+N5"
     "y+@2{)k"},
    {51, 652,
     " 50+w6g+h8V*`8W)r8V(]53'=2*'=1#'=.m'P-^'c-^(k.V(R0k(71~(74-(76@))6A)r6@*Y49+J2K+J0Q+J0Q,B2S,B41,B5y-#5z-]5y.;4"
     "-.z2K.z1P.z/H.h...T../T/H/e1]/u2^/u53/u81.g82-g81-'6X,,"},
    {52, 652,
     " 4Q.i.p*B4Q*B 3v/g6h/g6h*B9,*B9,)H6h)H6h'L4Q'L4Q)H-$)H-$*P"},
    {53, 652,
     " .C/g72/g72.m0I.m0I,i0u,q1s,y2E,y5/,y8F+H8G*-8F(j5''=2&'=0{'=.m'N-`'_-`(j._(P0k(71~(73u(76/)960*-6/*}3u+}1~+}1"
     ")+}/;+k.C+X"},
    {54, 652,
     " 3I,'1u,'0-+#0.*-0-)61u(33I(34w(36c)66d*-6c+#4w,' 7r/V7r.T7#.g5=.z4M.z27.z/u-L/f+y0F,I2B,y3U,y6%,y8y+I8z*-8y(o"
     "5w'=3I'=0R'=-P)P-Q+X-P-V17/u4E/u55/u6w/f"},
    {55, 652,
     " -j/g8K/g8K/;2I'L0*'L5f.m-j.m"},
    {56, 652,
     " 30+F1T+F/c*T/d)k/c)%1T(330(34g(36V)&6W)k6V*T4g+F 0t+s/L,'-o-%-p-g-o.g0_/u30/u5Z/u8J.g8K-g8J-%6o,'5G+s7#+a8o*X"
     "8p)k8o(X5s'=30'=0F'=-L(X-M)k-L*X/;+a 0*-^0),~1a,;30,;4V,;65,~66-^65.<4V/#30/#1a/#0).<"},
    {57, 652,
     " .G'].G(_/7(L0{(71n(74%(76F)f6U+95u*j3w*:2f*:07*:-@+i-A-)-@.C0B/u2t/u5g/u8k-c8l+X8k)]5''=1v'=1''=/@'L 2t+/4F+/"
     "6/,260-)6/-{4F/#2t/#1D/#/X-{/Y-)/X,21D+/"},
    {58, 345,
     " .W(r0x(r0x'L.W'L .W-B0x-B0x+w.W+w"},
    {59, 345,
     " .W-B0x-B0x+w.W+w .W(r0x(r0x'v/,&.-`&..W'v"},
    {60, 858,
     " <W-'1,+#<W(}<W'|.>*V.>+N<W.("},
    {61, 858,
     " .>,[<W,[<W+b.>+b .>*C<W*C<W)H.>)H"},
    {62, 858,
     " .>-'.>.(<W+N<W*V.>'|.>(}9j+#"},
    {63, 544,
     " 0:(r2Q(r2Q'L0:'L 2K)a0>)a0>*T0=++0w+n1z,=2x,k3V-*4--Z4.-s4-.E2a.}1O.}0Z.}.Z.Y-U.7-U/;.V/X0e/u1r/u3u/u6F.n6G-y"
     "6F-R5X,h4Y,;3[+l3++T2_+82W++2P*}2J*_2K*D"},
    {64, 1024,
     " 4E*J4D)^5y(g7A(g8c(g:9)_::*J:9+58_,.7>,.5y,.4D+6 :K(j9i(B8%'y6t'y4{'y2X)@2Y*J2X+T4},y6t,y8%,y9i,R:K,+:K,o<$,o"
     "<$(g=](q@L*+@M+)@L+a>i,e>(-1<u-u9X.`7^.`69.`3g.=2b-y0w-F.{+T.|*N.{)X09(&1M'L2Z&s5a&;7K&;8s&;;]&h<l'5=l&X<F&'9-"
     "%N7K%N5D%N1e&50>&u.s'X-H)I-I*N-H+N.w-@0>.#1g.e5P/M7Y/M9y/M=}.P@E-ZA3-(B'+kB(++B')^=T'z:K'w"},
    {65, 700,
     " 3b.^0^*R6h*R 2I/g4|/g;<'L8z'L7K)X/z)X.K'L,*'L"},
    {66, 702,
     " 0G+H0G(E3~(E5k(E7T)-7U)u7T*a5k+H3~+H 0G.o0G,@3d,@5B,@6{,y6|-W6{.55B.o3d.o ../g3r/g6J/g95.a96-c95,y7k,%6I+w8)+"
     "g9u*[9v)j9u(`6s'L4*'L..'L"},
    {67, 715,
     " :W/,:W-w9H.L6q.|5I.|2V.|/T-7/U+X/T)z2V(55I(56q(59H(g:W)::W(+9D'c6g'=5<'=1P'=-3)Y-4+X-3-X1P/u5</u6i/u9H/P"},
    {68, 788,
     " 0G.o0G(E3,(E6R(E9e)x9f+Z9e-;6R.o3,.o ../g2h/g7V/g<)-g<*+Z<))M7T'L2h'L..'L"},
    {69, 647,
     " ../g8[/g8[.m0G.m0G,B8<,B8<+H0G+H0G(G8p(G8p'L..'L"},
    {70, 589,
     " ../g7b/g7b.m0G.m0G,D6|,D6|+H0G+H0G'L..'L"},
    {71, 794,
     " 9M(]9M*r5j*r5j+k;b+k;b(7:D'i77'=5M'=1V'=-3)V-4+X-3-]1V/u5M/u7)/u9}/P;8/,;8-w9}.K73.|5^.|2Z.|/T-;/U+X/T)w2Z(55"
     "^(56o(58c(I"},
    {72, 770,
     " ../g0G/g0G,B8S,B8S/g:l/g:l'L8S'L8S+H0G+H0G'L..'L"},
    {73, 302,
     " ../g0G/g0G'L..'L"},
    {74, 302,
     " ../g0G/g0G(%0F&S.+%2+Y%2*f%2*f&-+I&-,w&-.-&z..(%"},
    {75, 672,
     " ../g0G/g0G,87n/g:d/g2O+s;>'L8C'L0G+L0G'L..'L"},
    {76, 570,
     " ../g0G/g0G(G8M(G8M'L..'L"},
    {77, 884,
     " ../g1O/g5f*+9|/g=A/g=A'L;.'L;..g6p)'4Y)'0>.g0>'L..'L"},
    {78, 766,
     " ../g10/g8S(m8S/g:d/g:d'L7b'L0>.F0>'L..'L"},
    {79, 806,
     " 4t.}2J.}/T-1/U+X/T*%2J(54t(57@(5:1*%:2+X:1-17@.} 4t/u8B/u<R-V<S+X<R)]8B'=4t'=1D'=-3)]-4+X-3-V1D/u"},
    {80, 618,
     " 0G.o0G+d34+d4i+d6N,R6O-;6N.#4i.o34.o ../g34/g5}/g8o.O8p-;8o,&5}*k34*k0G*k0G'L..'L"},
    {81, 806,
     " 4t.}2J.}/T-1/U+X/T*%2J(54t(57@(5:1*%:2+X:1-17@.} 8$'Z:|%}8:%}5n'@5J'=5''=4t'=1D'=-3)]-4+X-3-V1D/u4t/u8B/u<R-V"
     "<S+X<R*/:5(+"},
    {82, 712,
     " 5~+B6e+68)*I8l)e;('L8`'L6S)X5c*H41*{2p*{0G*{0G'L..'L../g34/g6%/g8o.V8p-D8o,W7F+T 0G.o0G+s34+s4o+s6N,]6O-D6N.*"
     "4o.o34.o"},
    {83, 650,
     " 8*/N8*.F6k.b4R.}3O.}1].}/_.;/`-[/_-)0{,Q2p,B42,46c+{9)*h9*)g9)(T5q'=2f'=1T'=.s'V-M'n-M(|.o(X1L(52f(54_(56g({6"
     "h)_6g*;57*{3S+.22+:/]+R-H,X-I-S-H.]0P/u38/u4F/u6m/b"},
    {84, 626,
     " +p/g9r/g9r.m3~.m3~'L1f'L1f.m+p.m"},
    {85, 750,
     " -t/g0./g0.*d0-)E2)(548(56F(58@)E8A*d8A/g:W/g:W*V:V(y7D'=48'=1+'=-s(y-t*V"},
    {86, 700,
     " 2I'L,*/g.K/g3b(i8z/g;</g4|'L"},
    {87, 1012,
     " ,`/g.x/g2I(g5v/g8I/g;v(g@E/gB`/g=Q'L:`'L72._3^'L0n'L"},
    {88, 702,
     " -A/g/h/g3r,`8$/g:K/g5,+i:l'L8E'L3d*}/$'L,W'L2Q+s"},
    {89, 626,
     " +r/g.:/g2t,B7K/g9r/g3~+H3~'L1f'L1f+H"},
    {90, 702,
     " -4/g:6/g:6.u/f(G:O(G:O'L,x'L,x(>7I.m-4.m"},
    {91, 400,
     " -r0+2W0+2W/=/v/=/v&g2W&g2W%z-r%z"},
    {92, 345,
     " -l/g3W&G1b&G+v/g"},
    {93, 400,
     " 2p0+2p%z..%z..&g0j&g0j/=../=..0+"},
    {94, 858,
     " 6S/g<W,_:A,_5K.q0U,_.>,_4C/g"},
    {95, 512,
     " 7Q%V7Q$i+b$i+b%V"},
    {96, 512,
     " /~0U3,.N1I.N-l0U"},
    {97, 628,
     " 3d*X17*X/@*#/A)A/@(k0g(/1~(/3a(/5e)C5f*C5f*X 7j+#7j'L5f'L5f(G5%'o2y'=1K'=/R'=-;(D-<):-;*@0)+F2t+F5f+F5f+N5e,3"
     "3s,{26,{1/,{/+,c.2,L.2-F/=-Z1H-o2I-o5+-o7i,J"},
    {98, 650,
     " 6|*V6{+b5-,{3Q,{1s,{0%+b0&*V0%)J1s(/3Q(/5-(/6{)J 0&,f0_-<2]-o3~-o69-o9+,%9,*V9+)+69'=3~'=2]'=0_'o0&(F0&'L-|'L"
     "-|0+0&0+"},
    {99, 563,
     " 7$-J7$,N6-,e4F,{3Q,{1P,{/@+c/A*V/@)I1P(13Q(14F(16-(G7$(]7$'c6/'P4='=3<'=0N'=-/)'-0*V-/,)0P-o3I-o4B-o61-]"},
    {100, 650,
     " 68,f680+8<0+8<'L68'L68(F5X'o3]'=2:'=/}'=-/)+-0*V-/,%/}-o2:-o3]-o5X-< /<*V/;)J1-(/2h(/4D(/67)J68*V67+b4D,{2h,{"
     "1-,{/;+b"},
    {101, 630,
     " 8d*n8d*@/<*@/H):1c(13f(14w(17-(L86(g86'i7+'T4k'=3['=0]'=-/)%-0*P-/,%0L-o3:-o5i-o8c,5 6`+-6Z+{4k,{3<,{1V,{/P+}"
     "/E+-"},
    {102, 360,
     " 4C0+4C/92G/91;/90J.m0K.70K-a3n-a3n,s0K,s0K'L.G'L.G,s,K,s,K-a.G-a.G.,.F//0=0+2I0+"},
    {103, 650,
     " 68*]67+g4F,{2h,{1+,{/;+g/<*]/;)S1+(>2h(>4F(>67)S 8<(78;&]5L%*2U%*1L%*/T%9.`%H.`&H/T&11@%x26%x47%x67&}68(&68(T"
     "5X'~3]'L2:'L/y'L-/)4-0*]-/,)/y-o2:-o3]-o5X-;68,f68-a8<-a"},
    {104, 649,
     " 8G+58G'L6C'L6C+26B,'4{,y3Y,y1y,y0%+s0&*{0&'L-|'L-|0+0&0+0&,d0g-;2g-o4&-o63-o8F,P"},
    {105, 284,
     " .&-a0*-a0*'L.&'L .&0+0*0+0*.m.&.m"},
    {106, 284,
     " .&-a0*-a0*'B0)&0.;%*,:%*+Q%*+Q%z,&%z-3%z.%&P.&'B .&0+0*0+0*.m.&.m"},
    {107, 593,
     " -|0+0&0+0&*}6.-a8h-a2.*i9$'L6C'L0&*P0&'L-|'L"},
    {108, 284,
     " .&0+0*0+0*'L.&'L"},
    {109, 998,
     " 7f,N8P-1:]-o<*-o>%-oA-,MA.+5A.'L>*'L>*+2>),)<m,y;Q,y9w,y8)+s8**{8*'L6&'L6&+26%,)4g,y3K,y1q,y0%+s0&*{0&'L-|'L-"
     "|-a0&-a0&,d0e-;2a-o4&-o5D-o7;-/"},
    {110, 649,
     " 8G+58G'L6C'L6C+26B,'4{,y3Y,y1y,y0%+s0&*{0&'L-|'L-|-a0&-a0&,d0g-;2g-o4&-o63-o8F,P"},
    {111, 626,
     " 2t,{17,{/@+a/A*V/@)K15(12t(14P(16H)L6I*V6H+`4P,{ 2t-o5T-o8V,+8W*V8V)%5T'=2t'=03'=-/)%-0*V-/,+03-o"},
    {112, 650,
     " 0&(F0&%*-|%*-|-a0&-a0&,f0_-<2]-o3~-o69-o9+,%9,*V9+)+69'=3~'=2]'=0_'o 6|*V6{+b5-,{3Q,{1s,{0%+b0&*V0%)J1s(/3Q(/"
     "5-(/6{)J"},
    {113, 650,
     " /<*V/;)J1-(/2h(/4D(/67)J68*V67+b4D,{2h,{1-,{/;+b 68(F5X'o3]'=2:'=/}'=-/)+-0*V-/,%/}-o2:-o3]-o5X-<68,f68-a8<-a"
     "8<%*68%*"},
    {114, 421,
     " 5:,e4w,n4+,w3[,w1s,w0%+k0&*f0&'L-|'L-|-a0&-a0&,d0_-;2g-o46-o4J-o4w-l58-i"},
    {115, 534,
     " 5~-P5~,R5+,g37,{2:,{0e,{/3,P/4,%/3+a0=+;1z++2^+#4m*k6_)x6`)16_(=3u'=1Q'=0P'=.B'O-0'a-0(g.9(K0N(/1U(/2}(/4T(^4"
     "U)+4T)Q3H)z1S*10n*8.w*K-7+;-8+}-7,s/e-o1~-o3/-o5/-_"},
    {116, 402,
     " 0*/K0*-a4<-a4<,s0*,s0*)P0)(g0u(>22(>4<(>4<'L22'L/m'L.#(B.$)P.$,s,S,s,S-a.$-a.$/K"},
    {117, 649,
     " -p)v-p-a/t-a/t)y/s)(19(32^(34=(365)766*/66-a8:-a8:'L66'L66(H5L'p3P'=26'=0''=-o(] 2|-o"},
    {118, 606,
     " ,W-a.h-a2^(L6S-a8d-a4&'L18'L"},
    {119, 838,
     " ,r-a.v-a1M(n3~-a6I-a8|(n;Q-a=U-a:>'L7v'L56,U2S'L0.'L"},
    {120, 606,
     " 8G-a3v*_8['L66'L2Y)u.|'L,W'L1G*d,|-a/E-a2b+L5~-a"},
    {121, 606,
     " 38&s2B%i0c%*/A%*-d%*-d%y.v%y/g%y0a&B18'*1['U,W-a.h-a2^(m6S-a8d-a"},
    {122, 538,
     " -0-a6t-a6t,g/4(;6t(;6t'L,t'L,t(F4W,q-0,q"},
    {123, 652,
     " 7U&G7U%Y6p%Y4)%Y25&I26'_26(|25)m1#*L/I*L.h*L.h+9/I+91#+925+u26,e26.'25/;4)0+6p0+7U0+7U/=6l/=55/=49.m4:.%4:,_4"
     "9+k37*}2&*q39*c49)w4:)'4:'a49&t55&G6l&G"},
    {124, 345,
     " 0b0/0b$i.l$i.l0/"},
    {125, 652,
     " .h&G/S&G1)&G2%&s2&'a2&)'2%)w3#*c4:*q3#*}2%+k2&,_2&.%2%.n1)/=/S/=.h/=.h0+/M0+250+4)/;4*.'4*,e4)+u5;+96p+97U+97"
     "U*L6p*L5;*L4))m4*(|4*'_4)&I25%Y/M%Y.h%Y"},
    {126, 858,
     " <W+}<W+#;F*V9H*38A*37+*35O*R5D*T5>*T57*V5(*X3@*y2>*y1@*y/H*Q.>*'.>+%/N+N1L+q2U+q3i+q5I+R5P+P5W+P5_+N5n+L7T++8"
     "W++9T++;H+R"},
    {161, 410,
     " 1Y,:/A,:/A-a1Y-a 1Y%F/A%F/A)$/W+#1E+#1Y)$"},
    {162, 652,
     " 3K(33K,y1m,o/}+X/~*V/})S1m(; 7b-J7b,N6o,d5@,y4W,{4W(15B(36s(I7b(]7b'c6y'R5H'A4W'=4W%e3K%e3K'@0g'J-m).-n*V-m+}"
     "0g-c3K-m3K/H4W/H4W-m5F-k6w-Z"},
    {163, 652,
     " 80/V80.U7=.k5k/#5,/#3L/#21./22,{22+j6S+j6S*}22*}22(G8E(G8E'L-A'L-A(G/z(G/z*}-h*}-h+j/z+j/z-+/y.T2B/u4x/u5X/u7"
     ";/e"},
    {164, 652,
     " 5n,{8,..9E-P7*,B7P,$7u+D7v+#7u*`7L*%7$)d9C(V8*'x5j))5-(q3o(_30(_2R(_13(q0Q)'.6'v,z(T/8)c.o*%.J*c.K+#.J+D.o,#/"
     "<,@,|-N.:.,0U,{1/-22J-F30-F3m-F5--3 60+%6/+_4J,P30,P1u,P01+_02+%01*F1u)R30)R4H)R6/*G"},
    {165, 652,
     " 8p)}4:)}4:'L2&'L2&)}-I)}-I*`2&*`2&*y1,+m-I+m-I,P0C,P,n/g.x/g30+q7A/g9M/g5v,P8p,P8p+m52+m48*y48*`8p*`"},
    {166, 345,
     " 0b)e0b%Q.l%Q.l)e 0b/H0b+4.l+4.l/H"},
    {167, 512,
     " 0.,_/H,G.e+u.f+^.e+609*N3()f3g)}4J*O4K*g4J+12o+w 5,/W5,.`43.s2Z/+1~/+0u/+/c._/d.9/c-i1~--2;-%2K,}4k,A67+N68*w"
     "67*H55)]42)B4s)'5P(L5Q(+5P'=37&D1A&D0P&D.k&S-n&c-n'Z.k'F0J'11('125'13L']3M('3L(]1$)>0f)F.B*',w*u,x+N,w+|-y,i.|"
     "-&.=-<-_-v-`.=-_/#/s/u1f/u2R/u47/g"},
    {168, 512,
     " 2^0)4t0)4t.z2^.z .>0)0U0)0U.z.>.z"},
    {169, 1024,
     " 7</c8{/c;u/+=,.O>=-s@P,J@Q+V@P*e>=);=,(a;u((8{'L7<'L5X'L2_((1M(a09);/'*e/(+V/',J09-s1M.O2_/+5X/c 7</.5m/.3@.Z"
     "2:.*17-V01,=02+V01*q17)X2:))3@(T5m($7<($8g($;;(T<>))=B)X>F*p>G+V>F,>=@-V<>.*;;.Z8g/. :[-i:[-'9q-78J-H7b-H6%-H4"
     "1,K42+V41*b6))e7n)e8R)e9q)u:[*):[)E9q)58B)'7U)'5/)'2D*H2E+V2D,f5/.)7U.)8D.)9s-w"},
    {170, 482,
     " -M*g5,*g5,*'-M*' 5(-w5(+J3I+J3I,'2w+d1@+A0>+A.s+A-3,)-4,d-3-L/=.71G.73I.73I.93H.h2-/90n/90-/9.Z/)-r.s-r/X._/g"
     "0;/u1(/u3)/u5'.w 1~-X05-X.m-5.n,j.m,I/u+}0n+}1{+}3H,k3I-J3I-X"},
    {171, 626,
     " 7b-B7b,;4C*k7b)=7b(72O*V2O+# 2t-B2t,;/S*k2t)=2t(7-`*V-`+#"},
    {172, 858,
     " .>,8<W,8<W)':d)':d+=.>+="},
    {174, 1024,
     " 7</.5m/.3@.Z2:.*17-V01,=02+V01*q17)X2:))3@(T5m($7<($8g($;;(T<>))=B)X>F*p>G+V>F,>=@-V<>.*;;.Z8g/. 7</c8{/c;u/+"
     "=,.O>=-s@P,J@Q+V@P*e>=);=,(a;u((8{'L7<'L5X'L2_((1M(a09);/'*e/(+V/',J09-s1M.O2_/+5X/c 6|-H5[-H5[+s6|+s85+s91,59"
     "2,]91-'83-H 7(-|9#-|:y-@:z,^:y,19i+T8d+L8{+H9e*|:8*V;j)A9r)A8I*P7i+%6y+>6C+>5[+>5[)A3v)A3v-|"},
    {175, 512,
     " .:/x4x/x4x/,.:/,"},
    {176, 512,
     " 1Y/30c/3/N.V/O.-/N-a0c-)1Y-)2N-)3c-a3d.-3c.V2N/3 1Y/u2=/u3Z/]4*/D4Z/-5+.O5,.-5+-F3',D1W,D0),D.)-D.*.-.).r0-/u"},
    {177, 858,
     " 6E.X6E,J<W,J<W+P6E+P6E)B4Q)B4Q+P.>+P.>,J4Q,J4Q.X .>(G<W(G<W'L.>'L"},
    {178, 410,
     " .t+l3Y+l3Y+1,z+1,z+j-@+y.&,91q-z1r.N1q.p0c/=/h/=/1/=-m/+-$.u-$/X-q/g/B/u/~/u1X/u3R/13S.V3R-k/r,5/7+y"},
    {179, 410,
     " 1f-a2g-W3q,{3r,R3q+o1i+)/l+)//+)-i+4,~+>,~+}-V+o.s+b/^+b0o+b21,-22,R21,w0y-B/h-B.l-B.l-y/p-y0s-y1y.=1z.]1y.z0"
     "o/=/l/=/B/=.5/3-A/(-A/c.-/l/T/u02/u1i/u3]/83^.c3].>2]-j"},
    {180, 512,
     " 300U5C0U1f.M0&.M"},
    {181, 652,
     " -p%*-p-a/t-a/t)m/s)#1H(32x(34V(365)-66*'66-a8:-a8:(t89(U8_(79((79/(79P(=9n(D9n'T9D'H8V'=82'=7H'=6N'e6A(15i'f4"
     "1'=3('=1y'=0B'e/t(1/t%*"},
    {182, 652,
     " 2x/g7v/g7v&D6C&D6C/(48/(48&D2`&D2`+'09+0-_,F-`-H-_.L0T/g"},
    {183, 326,
     " .C,,0b,,0b*c.C*c"},
    {184, 512,
     " 2S'L3/',3e&R3f&93e%i2F%91,%90V%9/Z%@/0%F/0&-/P&%0B%y0r%y1P%y21&522&M21&]1c'-14'L"},
    {185, 410,
     " -^+j/v+j/v/1-I.y-I/X/~/m1Q/m1Q+j3j+j3j+1-^+1"},
    {186, 482,
     " -M*g5,*g5,*'-M*' 1</u39/u5T.a5U-Z5T,T39+A1<+A/;+A,{,U,|-Z,{.a/;/u 1</90+/9.c.D.d-Z.c,s0-+}1<+}2J+}3m,s3n-Z3m."
     "D2J/9"},
    {187, 626,
     " .&-B3:+#3:*V.&(7.&)=1G*k.&,; 2t-B8*+#8**V2t(72t)=66*k2t,;"},
    {188, 992,
     " -^+j/v+j/v/1-I.y-I/X/~/m1Q/m1Q+j3j+j3j+1-^+1 >.+I:d)+>.)+ =t,+@f,+@f)+B8)+B8(O@f(O@f'L>.'L>.(O9S(O9S)1 ;6/u<~"
     "/u2^'=0r'="},
    {189, 992,
     " -^+j/v+j/v/1-I.y-I/X/~/m1Q/m1Q+j3j+j3j+1-^+1 ;n(*AS(*AS'L9r'L9r((:9(7:z(T>i*8>j*i>i+.=Z+X<`+X<)+X:g+F9z+39z+s"
     ":k,%<9,3<v,3>R,3AJ+LAK*qAJ*)<j(P</(7 ;6/u<~/u2^'=0r'="},
    {190, 992,
     " 1f-a2g-W3q,{3r,R3q+o1i+)/l+)//+)-i+4,~+>,~+}-V+o.s+b/^+b0o+b21,-22,R21,w0y-B/h-B.l-B.l-y/p-y0s-y1y.=1z.]1y.z0"
     "o/=/l/=/B/=.5/3-A/(-A/c.-/l/T/u02/u1i/u3]/83^.c3].>2]-j >.+I:d)+>.)+ =t,+@f,+@f)+B8)+B8(O@f(O@f'L>.'L>.(O9S(O9"
     "S)1 ;6/u<~/u2^'=0r'="},
    {191, 544,
     " 1M+L3W+L3W*X3V*$2{)=1z(m0|(@0=(%/g'Q/h'7/g&g13&.2I&.3;&.5;&R6C&u6C%q5=%S31%62&%6/}%6-P&=-Q'3-P'Z.=(D/<(p0:)@0"
     "k)X17)s1A*#1F*.1L*M1M*i 3^,:1G,:1G-a3^-a"},
    {192, 700,
     " 3b.^0^*R6h*R 2I/g4|/g;<'L8z'L7K)X/z)X.K'L,*'L 3(2#580T3S0T0|2#"},
    {193, 700,
     " 3b.^0^*R6h*R 2I/g4|/g;<'L8z'L7K)X/z)X.K'L,*'L 4>2#6C2#3n0T2.0T"},
    {194, 700,
     " 3b.^0^*R6h*R 2I/g4|/g;<'L8z'L7K)X/z)X.K'L,*'L 2^2#4f2#7(0T5S0T3b1R1p0T0>0T"},
    {195, 700,
     " 3b.^0^*R6h*R 2I/g4|/g;<'L8z'L7K)X/z)X.K'L,*'L 3^0z3$1/2e152F1;2:1;1q1;1H0~1I0g1I0e0$0e0#1;1/1x2.1x2R1x331p3f1"
     "c4C1R4Z1L4}1F501F5P1F5y1a5z1u5z1x7C1x7@1E610e580e4s0e450m"},
    {196, 700,
     " 3b.^0^*R6h*R 2I/g4|/g;<'L8z'L7K)X/z)X.K'L,*'L 4f1p6|1p6|0e4f0e 0G1p2^1p2^0e0G0e"},
    {197, 700,
     " 5E0O5D0o4F1A3b1A2{1A1}0q1~0O1}0/2{/_3b/_4F/_5D0/ 3b.^0`*R6d*R 1~/51@/K0]0)0^0O0]1-2F2#3b2#4y2#6g1-6h0O6g0+6%/"
     "K5E/5;<'L8z'L7K)X/z)X.K'L,*'L"},
    {198, 998,
     " AG/gAG.m82.m82,BA*,BA*+H82+H82(GA[(GA['L5v'L5v)X0&)X.:'L+~'L2x/g 4O.s0n*R5v*R5v.s"},
    {199, 715,
     " :W/,:W-w9H.L6q.|5I.|2V.|/T-7/U+X/T)z2V(55I(56q(59H(g:W)::W(+9D'c6g'=5<'=1P'=-3)Y-4+X-3-X1P/u5</u6i/u9H/P 5r'L"
     "6N',7)&R7*&97)%i5g%94K%93w%92{%@2O%F2O&-2q&%3a%y46%y4q%y5R&55S&M5R&]5''-4U'L"},
    {200, 647,
     " ../g8[/g8[.m0G.m0G,B8<,B8<+H0G+H0G(G8p(G8p'L..'L 2d2#4t0T340T0^2#"},
    {201, 647,
     " ../g8[/g8[.m0G.m0G,B8<,B8<+H0G+H0G(G8p(G8p'L..'L 3z2#6$2#3O0T1j0T"},
    {202, 647,
     " ../g8[/g8[.m0G.m0G,B8<,B8<+H0G+H0G(G8p(G8p'L..'L 2>2#4G2#6h0T540T3C1R1Q0T/z0T"},
    {203, 647,
     " ../g8[/g8[.m0G.m0G,B8<,B8<+H0G+H0G(G8p(G8p'L..'L 4G1p6`1p6`0e4G0e 0&1p2>1p2>0e0&0e"},
    {204, 302,
     " ../g0G/g0G'L..'L .^2#0n0T/,0T,W2#"},
    {205, 302,
     " ../g0G/g0G'L..'L /t2#1z2#/I0T-d0T"},
    {206, 302,
     " ../g0G/g0G'L..'L .62#0>2#2`0T1,0T/<1R-I0T+t0T"},
    {207, 302,
     " ../g0G/g0G'L..'L 0>1p2W1p2W0e0>0e +|1p.61p.60e+|0e"},
    {208, 794,
     " .:/g2t/g7a/g<3-g<4+Z<3)M7a'L2t'L.:'L.:+B,$+B,$,/.:,/ 0Q.o0Q,/48,/48+B0Q+B0Q(E34(E6](E9m)x9n+Z9m-;6].o34.o"},
    {209, 766,
     " ../g10/g8S(m8S/g:d/g:d'L7b'L0>.F0>'L..'L 4E0z3f1/3L153+1;2|1;2V1;2-0~2.0g2.0e0h0e0g1;1u1x2p1x371x3w1p4M1c5,1R"
     "5B1L5e1F5v1F691F6c1a6d1u6d1x8*1x8'1E6w0e5~0e5X0e4y0m"},
    {210, 806,
     " 4t.}2J.}/T-1/U+X/T*%2J(54t(57@(5:1*%:2+X:1-17@.} 4t/u8B/u<R-V<S+X<R)]8B'=4t'=1D'=-3)]-4+X-3-V1D/u 482#6I0T4d0"
     "T222#"},
    {211, 806,
     " 4t.}2J.}/T-1/U+X/T*%2J(54t(57@(5:1*%:2+X:1-17@.} 4t/u8B/u<R-V<S+X<R)]8B'=4t'=1D'=-3)]-4+X-3-V1D/u 5O2#7U2#5$0"
     "T3>0T"},
    {212, 806,
     " 4t.}2J.}/T-1/U+X/T*%2J(54t(57@(5:1*%:2+X:1-17@.} 4t/u8B/u<R-V<S+X<R)]8B'=4t'=1D'=-3)]-4+X-3-V1D/u 3n2#5v2#8:0"
     "T6d0T4t1R3$0T1O0T"},
    {213, 806,
     " 4t.}2J.}/T-1/U+X/T*%2J(54t(57@(5:1*%:2+X:1-17@.} 4t/u8B/u<R-V<S+X<R)]8B'=4t'=1D'=-3)]-4+X-3-V1D/u 4p0z441/3u1"
     "53V1;3K1;3%1;2X0~2Y0g2Y0e140e131;2B1x3>1x3c1x4F1p4x1c5U1R5m1L611F6C1F6c1F7/1a701u701x8S1x8R1E7D0e6K0e6'0e5H0m"},
    {214, 806,
     " 4t.}2J.}/T-1/U+X/T*%2J(54t(57@(5:1*%:2+X:1-17@.} 4t/u8B/u<R-V<S+X<R)]8B'=4t'=1D'=-3)]-4+X-3-V1D/u 5v1p821p820"
     "e5v0e 1W1p3n1p3n0e1W0e"},
    {215, 858,
     " ;r-V6l+#;r(N:S'm5K*C0C'm/$(N4*+#/$-V0C.75K+b:S.7"},
    {216, 806,
     " 9>-]1A(x2%(W3m(54t(57@(5:1*%:2+X:1,59e-7 8G.97e.Z5w.}4t.}2J.}/T-1/U+X/T*{/})w0I)T .x(a.')7-3*c-4+X-3-V1D/u4t/"
     "u6=/u8i/N9f/';U0-<`/[:l.R;]-y<R,N<S+X<R)]8B'=4t'=3L'=0}'d/~(-.2'(-&'U"},
    {217, 750,
     " -t/g0./g0.*d0-)E2)(548(56F(58@)E8A*d8A/g:W/g:W*V:V(y7D'=48'=1+'=-s(y-t*V 3Y2#5j0T4*0T1S2#"},
    {218, 750,
     " -t/g0./g0.*d0-)E2)(548(56F(58@)E8A*d8A/g:W/g:W*V:V(y7D'=48'=1+'=-s(y-t*V 4p2#6v2#4E0T2`0T"},
    {219, 750,
     " -t/g0./g0.*d0-)E2)(548(56F(58@)E8A*d8A/g:W/g:W*V:V(y7D'=48'=1+'=-s(y-t*V 342#5<2#7^0T6*0T481R2G0T0p0T"},
    {220, 750,
     " -t/g0./g0.*d0-)E2)(548(56F(58@)E8A*d8A/g:W/g:W*V:V(y7D'=48'=1+'=-s(y-t*V 5<1p7U1p7U0e5<0e 0x1p341p340e0x0e"},
    {221, 626,
     " +r/g.:/g2t,B7K/g9r/g3~+H3~'L1f'L1f+H 3O2#5U2#3$0T1>0T"},
    {222, 620,
     " ../g0G/g0G.;34.;5}.;8o-%8p+m8o*X5})A34)A0G)A0G'L..'L 0G-D0G*934*94i*96N+(6O+m6N,U4k-D34-D"},
    {223, 645,
     " -|-i-{.s0Z0+3(0+5D0+7k.m7n-V6/-R4;,s4<,B4;,*4w+]5^+H6<+48-*Z93)n94):93(>6c'=4C'=3]'=2-'J1A'V1A(N25(>3i(/4O(/5"
     "i(/7+(a7,)37+)S6J)~5A*B4>*_37*|29+e2:,729,y4--u5n.'5e.]49/93$/91T/90%.N0&-g0&'L-|'L"},
    {224, 628,
     " 3d*X17*X/@*#/A)A/@(k0g(/1~(/3a(/5e)C5f*C5f*X 7j+#7j'L5f'L5f(G5%'o2y'=1K'=/R'=-;(D-<):-;*@0)+F2t+F5f+F5f+N5e,3"
     "3s,{26,{1/,{/+,c.2,L.2-F/=-Z1H-o2I-o5+-o7i,J 0t0U4&.N2A.N.d0U"},
    {225, 628,
     " 3d*X17*X/@*#/A)A/@(k0g(/1~(/3a(/5e)C5f*C5f*X 7j+#7j'L5f'L5f(G5%'o2y'=1K'=/R'=-;(D-<):-;*@0)+F2t+F5f+F5f+N5e,3"
     "3s,{26,{1/,{/+,c.2,L.2-F/=-Z1H-o2I-o5+-o7i,J 4&0U6:0U2^.M0x.M"},
    {226, 628,
     " 3d*X17*X/@*#/A)A/@(k0g(/1~(/3a(/5e)C5f*C5f*X 7j+#7j'L5f'L5f(G5%'o2y'=1K'=/R'=-;(D-<):-;*@0)+F2t+F5f+F5f+N5e,3"
     "3s,{26,{1/,{/+,c.2,L.2-F/=-Z1H-o2I-o5+-o7i,J 1b0U3A0U6&.M4Q.M2Q/o0Q.M.|.M"},
    {227, 628,
     " 3d*X17*X/@*#/A)A/@(k0g(/1~(/3a(/5e)C5f*C5f*X 7j+#7j'L5f'L5f(G5%'o2y'=1K'=/R'=-;(D-<):-;*@0)+F2t+F5f+F5f+N5e,3"
     "3s,{26,{1/,{/+,c.2,L.2-F/=-Z1H-o2I-o5+-o7i,J 2M/(1n/D1X/N15/X1(/X0_/X09/306.e.p.e.q/N/}0=1$0=1H0=2-0/2U/z34/_3"
     "H/T3k/J3z/J4B/J4g/o4l0=620=6//T5#.e3~.e3X.e2s.s"},
    {228, 628,
     " 3d*X17*X/@*#/A)A/@(k0g(/1~(/3a(/5e)C5f*C5f*X 7j+#7j'L5f'L5f(G5%'o2y'=1K'=/R'=-;(D-<):-;*@0)+F2t+F5f+F5f+N5e,3"
     "3s,{26,{1/,{/+,c.2,L.2-F/=-Z1H-o2I-o5+-o7i,J 3U0)5n0)5n.z3U.z /40)1M0)1M.z/4.z"},
    {229, 628,
     " 3d*X17*X/@*#/A)A/@(k0g(/1~(/3a(/5e)C5f*C5f*X 7j+#7j'L5f'L5f(G5%'o2y'=1K'=/R'=-;(D-<):-;*@0)+F2t+F5f+F5f+N5e,3"
     "3s,{26,{1/,{/+,c.2,L.2-F/=-Z1H-o2I-o5+-o7i,J 44/w430;350i2Q0i1i0i0m0;0n/w0m/V1i/)2Q/)35/)43/V 5U/w5T/;3i.F2Q.F"
     "17.F/L/;/M/w/L0V171K2Q1K3i1K5T0V"},
    {230, 1006,
     " >~+->{+{=/,{;^,{9w,{7q+}7f+- 6|,m7i-=:--o;Y-o>--oB',5B(*nB(*@7^*@7i)9:%(/<*(/=7(/@L(KAW(gAW'i@L'T=/'=;|'=:-'="
     "7D'{6Q(]5a'{3;'=1d'=/X'=-;(A-<):-;*@0)+F2t+F5f+F5f+N5e,33s,{26,{1/,{/+,c.2,L.2-F/=-Z1H-o2I-o3}-o6B-= 3d*X17*X/"
     "@*#/A)A/@(k0g(/1~(/3a(/5e)C5f*C5f*X"},
    {231, 563,
     " 7$-J7$,N6-,e4F,{3Q,{1P,{/@+c/A*V/@)I1P(13Q(14F(16-(G7$(]7$'c6/'P4='=3<'=0N'=-/)'-0*V-/,)0P-o3I-o4B-o61-] 4.'L"
     "4e',5@&R5A&95@%i3}%92b%921%913%@0f%F0f&-1+&%1w%y2K%y3+%y3i&53j&M3i&]3;'-2l'L"},
    {232, 630,
     " 8d*n8d*@/<*@/H):1c(13f(14w(17-(L86(g86'i7+'T4k'=3['=0]'=-/)%-0*P-/,%0L-o3:-o5i-o8c,5 6`+-6Z+{4k,{3<,{1V,{/P+}"
     "/E+- 1S0U4`.N2|.N/A0U"},
    {233, 630,
     " 8d*n8d*@/<*@/H):1c(13f(14w(17-(L86(g86'i7+'T4k'=3['=0]'=-/)%-0*P-/,%0L-o3:-o5i-o8c,5 6`+-6Z+{4k,{3<,{1V,{/P+}"
     "/E+- 4b0U6t0U3<.M1W.M"},
    {234, 630,
     " 8d*n8d*@/<*@/H):1c(13f(14w(17-(L86(g86'i7+'T4k'=3['=0]'=-/)%-0*P-/,%0L-o3:-o5i-o8c,5 6`+-6Z+{4k,{3<,{1V,{/P+}"
     "/E+- 2>0U3z0U6b.M50.M30/o10.M/Y.M"},
    {235, 630,
     " 8d*n8d*@/<*@/H):1c(13f(14w(17-(L86(g86'i7+'T4k'=3['=0]'=-/)%-0*P-/,%0L-o3:-o5i-o8c,5 6`+-6Z+{4k,{3<,{1V,{/P+}"
     "/E+- 420)6K0)6K.z42.z /p0)2*0)2*.z/p.z"},
    {236, 284,
     " -M0U0Y.N.t.N+<0U .&-a0*-a0*'L.&'L /(-o"},
    {237, 284,
     " 0[0U2p0U/4.M-Q.M .&-a0*-a0*'L.&'L /(-o"},
    {238, 284,
     " .&-a0*-a0*'L.&'L /(-o .:0U/v0U2[.M1(.M/(/o-(.M+S.M"},
    {239, 284,
     " .&-a0*-a0*'L.&'L /(-o 0.0)2E0)2E.z0..z +j0).&0).&.z+j.z"},
    {240, 626,
     " 56,T4_,]3a,e38,e1D,e/@+R/A*J/@)F17(12t(14N(16H)F6I*J6H+-5m,1 5v-k7@,~8V+G8W*J8V)$5H'=2t'=0='=-/)$-0*J-/+o05-U"
     "2b-U2s-U3L-R3x-P22.P.[-u.:.L1E.{/E0+1v0+3>/=7$/v7E/D4*.o"},
    {241, 649,
     " 8G+58G'L6C'L6C+26B,'4{,y3Y,y1y,y0%+s0&*{0&'L-|'L-|-a0&-a0&,d0g-;2g-o4&-o63-o8F,P 38/(2[/D2B/N1}/X1r/X1H/X1#/3"
     "1$.e/[.e/]/N0i0=1j0=250=2w0/3A/z3z/_45/T4V/J4d/J5//J5T/o5U0=6z0=6w/T5k.e4l.e4B.e3].s"},
    {242, 626,
     " 2t,{17,{/@+a/A*V/@)K15(12t(14P(16H)L6I*V6H+`4P,{ 2t-o5T-o8V,+8W*V8V)%5T'=2t'=03'=-/)%-0*V-/,+03-o 1:0U4G.N2d."
     "N/(0U"},
    {243, 626,
     " 2t,{17,{/@+a/A*V/@)K15(12t(14P(16H)L6I*V6H+`4P,{ 2t-o5T-o8V,+8W*V8V)%5T'=2t'=03'=-/)%-0*V-/,+03-o 4I0U6[0U3$."
     "M1>.M"},
    {244, 626,
     " 2t,{17,{/@+a/A*V/@)K15(12t(14P(16H)L6I*V6H+`4P,{ 2t-o5T-o8V,+8W*V8V)%5T'=2t'=03'=-/)%-0*V-/,+03-o 2&0U3b0U6I."
     "M4t.M2t/o0t.M/A.M"},
    {245, 626,
     " 2t,{17,{/@+a/A*V/@)K15(12t(14P(16H)L6I*V6H+`4P,{ 2t-o5T-o8V,+8W*V8V)%5T'=2t'=03'=-/)%-0*V-/,+03-o 2p/(24/D1y/"
     "N1X/X1K/X1#/X0Z/30Y.e/4.e/7/N0B0=1E0=1k0=2P0/2x/z3U/_3k/T41/J4>/J4e/J5-/o500=6S0=6R/T5D.e4E.e3y.e37.s"},
    {246, 626,
     " 2t,{17,{/@+a/A*V/@)K15(12t(14P(16H)L6I*V6H+`4P,{ 2t-o5T-o8V,+8W*V8V)%5T'=2t'=03'=-/)%-0*V-/,+03-o 3v0)620)62."
     "z3v.z /W0)1n0)1n.z/W.z"},
    {247, 858,
     " 4*-i6l-i6l,F4*,F 4*)_6l)_6l(<4*(< .>+P<W+P<W*T.>*T"},
    {248, 626,
     " 5z+u0U(Z1#(F2/(12t(14P(16H)L6I*V6H*~63+_ 52,P4c,f3T,{2t,{13,{/@+_/A*N/@*)/R)N/h)5 .C(E-i(m-/)u-0*V-/,+03-o2t-"
     "o3u-o5a-T6I-97z.39$-g7G,h7},@8V+78W*V8V)%5T'=2t'=1m'=0#'X/A'r-j&x,d'D"},
    {249, 649,
     " -p)v-p-a/t-a/t)y/s)(19(32^(34=(365)766*/66-a8:-a8:'L66'L66(H5L'p3P'=26'=0''=-o(] 2|-o 1C0U4O.N2l.N/00U"},
    {250, 649,
     " -p)v-p-a/t-a/t)y/s)(19(32^(34=(365)766*/66-a8:-a8:'L66'L66(H5L'p3P'=26'=0''=-o(] 2|-o 4Q0U6d0U3,.M1G.M"},
    {251, 649,
     " -p)v-p-a/t-a/t)y/s)(19(32^(34=(365)766*/66-a8:-a8:'L66'L66(H5L'p3P'=26'=0''=-o(] 2|-o 2.0U3j0U6Q.M4|.M2|/o0|."
     "M/I.M"},
    {252, 649,
     " -p)v-p-a/t-a/t)y/s)(19(32^(34=(365)766*/66-a8:-a8:'L66'L66(H5L'p3P'=26'=0''=-o(] 2|-o 3~0)6:0)6:.z3~.z /`0)1v"
     "0)1v.z/`.z"},
    {253, 606,
     " 38&s2B%i0c%*/A%*-d%*-d%y.v%y/g%y0a&B18'*1['U,W-a.h-a2^(m6S-a8d-a 420U6G0U2j.M1(.M"},
    {254, 650,
     " 0&(F0&%*-|%*-|0+0&0+0&,f0_-<2]-o3~-o69-o9+,%9,*V9+)+69'=3~'=2]'=0_'o 6|*V6{+b5-,{3Q,{1s,{0%+b0&*V0%)J1s(/3Q(/"
     "5-(/6{)J"},
    {255, 606,
     " 38&s2B%i0c%*/A%*-d%*-d%y.v%y/g%y0a&B18'*1['U,W-a.h-a2^(m6S-a8d-a 3b0)5z0)5z.z3b.z /A0)1Y0)1Y.z/A.z"},
    {913, 700,
     " 3b.^0^*R6h*R 2I/g4|/g;<'L8z'L7K)X/z)X.K'L,*'L"},
    {914, 702,
     " 0G+H0G(E3~(E5k(E7T)-7U)u7T*a5k+H3~+H 0G.o0G,@3d,@5B,@6{,y6|-W6{.55B.o3d.o ../g3r/g6J/g95.a96-c95,y7k,%6I+w8)+"
     "g9u*[9v)j9u(`6s'L4*'L..'L"},
    {915, 570,
     " ..'L../g8M/g8M.m0G.m0G'L"},
    {916, 700,
     " 3b.^/.(F8:(F ,*'L2I/g4|/g;<'L"},
    {917, 647,
     " ../g8[/g8[.m0G.m0G,B8<,B8<+H0G+H0G(G8p(G8p'L..'L"},
    {918, 702,
     " -4/g:6/g:6.u/f(G:O(G:O'L,x'L,x(>7I.m-4.m"},
    {919, 770,
     " ../g0G/g0G,B8S,B8S/g:l/g:l'L8S'L8S+H0G+H0G'L..'L"},
    {920, 806,
     " 0x,B8l,B8l+G0x+G 4t.}2J.}0~.)/T-1/U+X/T*%2J(54t(57@(58h)-:1*%:2+X:1-18h.)7@.} 4t/u8B/u<R-V<S+X<R)]:K(M8B'=4t'"
     "=1D'=/<(L-3)]-4+X-3-V/<.f1D/u"},
    {921, 302,
     " ../g0G/g0G'L..'L"},
    {922, 672,
     " ../g0G/g0G,87n/g:d/g2O+s;>'L8C'L0G+L0G'L..'L"},
    {923, 700,
     " .K'L,*'L2I/g4|/g;<'L8z'L3b.^"},
    {924, 884,
     " ../g1O/g5f*+9|/g=A/g=A'L;.'L;..g6p)'4Y)'0>.g0>'L..'L"},
    {925, 766,
     " ../g10/g8S(m8S/g:d/g:d'L7b'L0>.F0>'L..'L"},
    {926, 647,
     " />,B74,B74+H/>+H ../g8E/g8E.m...m ..(G8E(G8E'L..'L"},
    {927, 806,
     " 4t.}2J.}/T-1/U+X/T*%2J(54t(57@(5:1*%:2+X:1-17@.} 4t/u8B/u<R-V<S+X<R)]8B'=4t'=1D'=-3)]-4+X-3-V1D/u"},
    {928, 770,
     " :l/g:l'L8S'L8S.m0G.m0G'L..'L../g"},
    {929, 618,
     " 0G.o0G+d34+d4i+d6N,R6O-;6N.#4i.o34.o ../g34/g5}/g8o.O8p-;8o,&5}*k34*k0G*k0G'L..'L"},
    {931, 647,
     " 0d(G8p(G8p'L..'L..(G3M+r...m../g8[/g8[.m0d.m6&+t"},
    {932, 626,
     " +p/g9r/g9r.m3~.m3~'L1f'L1f.m+p.m"},
    {933, 626,
     " +r/g.:/g2t,B7K/g9r/g3~+H3~'L1f'L1f+H"},
    {934, 806,
     " 3h-x2)-m0~-A/T,c/U+X/T*P0~)q2))E3h)9 5~)97_)E8h)q:1*P:2+X:1,c8h-A7_-m5~-x 3h(A1%(L/<)4-3**-4+X-3-+/<-}1#.g3h."
     "r3h/g5~/g5~.r8c.g:K-}<R-+<S+X<R*+:K)48c(L5~(@5~'L3h'L"},
    {935, 702,
     " -A/g/h/g3r,`8$/g:K/g5,+i:l'L8E'L3d*}/$'L,W'L2Q+s"},
    {936, 806,
     " 3h'L3i(43h)21D)2/<*B-7+N-4-N-4/g/U/g/U-N/T+v0~*~25*63h*/3h/g5~/g5~*/7R*68h*~:3+v:4-N:4/g<W/g<W-N<P+N:M*B8D)25"
     "~)25}(j5~'L"},
    {937, 782,
     " <K(K<K'L5j'L5j(K7e(}8p)u9w*o9x+y9w-;8M.*6}.u4Y.u23.u/7-;/8+y/7*o0C)u1L(}3K(K3K'L,j'L,j(K0>(K.V)5-h*&,y*s,z+u,"
     "y-_/*.h13/q4Y/q7y/q:,.h<7-`<8+y<7*s;M*':_)78t(K"},
    {938, 302,
     " 0>1p2W1p2W0e0>0e +|1p.61p.60e+|0e ../g0G/g0G'L..'L"},
    {939, 626,
     " 3v1p601p600e3v0e /U1p1n1p1n0e/U0e +r/g.:/g2t,B7K/g9r/g3~+H3~'L1f'L1f+H"},
    {940, 675,
     " 5>*B4n+]4=,y2C,y0o,y02,B/@+V/A*V/@)B00(h0}(12C(13m(14[)B 6K,'7U-a9E-a7,*=7U)*7](m8&(X8N(@8p(@9n(@9n'L8Y'L7T'L"
     "6['w61(05|(^5L(%4I'T3w'@2C'@/e'@.M(1-/)%-0*V-/,3.W,{0--m2C-m5k-m 4C0U6W0U2z.M18.M"},
    {941, 554,
     " 4&0U680U2[.M0x.M 0>*m/'*y.G+=-e+_-f,2-e,{.|-G07-o2I-o39-o5/-c68-V68,]5/,l4:,s3D,y2W,y19,y0O,b/e,J/f,)/e+b0O+J"
     "15+32Q+346+346*B2W*B1'*B0:*(/F)h/G):/F(i0A(L1;(/2z(/3}(/4x(85q(B6`(U6`'Z5_'L4f'D3i'=2t'=09'=.n'l-D(=-E):-D)r.w"
     "*a"},
    {942, 649,
     " 5A0U7U0U3x.M26.M 8G+58G%*6C%*6C+26B,'4{,y3Y,y1y,y0%+s0&*{0&'L-|'L-|-a0&-a0&,d0g-;1h-T2g-o4&-o63-o7<-18F,P"},
    {943, 346,
     " /r-a/r)_/q(p06(X0Z(@1n(@2n(@2n'L1Y'L/X'L.`'}-i(S-j)d-h-a 1(0U3<0U/`.M-z.M"},
    {944, 592,
     " /`-a/`)_/_(u06(T0o(12$(13a(14p)@5P){5b+#5i+W5I,<5+,y3z-a5~-a5~-a6k-27<,P7g+q7h*~7g)X6A(U4X'<1j'=/i'=.`'{-V(Z-"
     "W)d-U-a 2x0)540)54.z2x.z .Y0)0p0)0p.z.Y.z 3K2W5^2W2&0O0A0O"},
    {945, 675,
     " 5>*B4n+]4=,y2C,y0o,y02,B/@+V/A*V/@)B00(h0}(12C(13m(14[)B 6K,'7U-a9E-a7,*=7U)*7](m8&(X8N(@8p(@9n(@9n'L8Y'L7T'L"
     "6['w61(05|(^5L(%4I'T3w'@2C'@/e'@.M(1-/)%-0*V-/,3.W,{0--m2C-m5k-m"},
    {946, 654,
     " 0*'o0*%*.&%*.&-].%012j017X017Y.%7X,Q5b+z8k+L8l){8k'B3K'B1)'B 0*)11@(53Q(56c(56d)z6c+R1U+G1U,B5X,B5Y.-5X/B2~/B"
     "0)/B0*-Z"},
    {947, 606,
     " /v,c2^(q6S-a8d-a3`'L3`%*1[%*1['L.C,+-q,l,l,l,:,l,:-a-&-a/7-a"},
    {948, 626,
     " 7(._5w/'3</'0L/'0M.G0L-t3G-[5c-H7$,k8V,&8W*P8V)%7((15T'=2t'=05'=.b(1-/)%-0*V-/+c.b,Z/;,{0,-1.D-Z.E.F.D/u3</u5"
     "e/u7(/Q 1^,t0s,e0:,@/@+c/A*V/@)J0:(l15(12t(14P(16H)L6I*P6H+Z5I,/4@,e2x,j25,m"},
    {949, 554,
     " 0>*m/'*y.G+=-e+_-f,2-e,{.|-G07-o2I-o39-o5/-c68-V68,]5/,l4:,s3D,y2W,y19,y0O,b/e,J/f,)/e+b0O+J15+32Q+346+346*B2"
     "W*B1'*B0:*(/F)h/G):/F(i0A(L1;(/2z(/3}(/4x(85q(B6`(U6`'Z5_'L4f'D3i'=2t'=09'=.n'l-D(=-E):-D)r.w*a"},
    {950, 557,
     " 3p(15=(062'g7+'=7,&]7+%}6>%T5H%(3Y%(3X%N3Y%u4B%s4p&-53&@54&R53&m4p''4N'=3p'=-+'=-,*I-+-03K/)-S/)-S0+740+74/)/"
     "/-'/0*I//(1"},
    {951, 649,
     " 8G+58G%*6C%*6C+26B,'4{,y3Y,y1y,y0%+s0&*{0&'L-|'L-|-a0&-a0&,d0g-;1h-T2g-o4&-o63-o7<-18F,P"},
    {952, 626,
     " 6G+G/A+G/P)g0:)%15(12t(14R(15M)%69)m 6E,B6'-w5M.N4P/C2t/C11/C0:.O/T-k/C,B 2t035T037(/#8V-o8W+i8V)b7((Q5T'@2t'"
     "@03'@.b(Q-/)b-0+i-/-o.b/#0303"},
    {953, 346,
     " /r-a/r)_/q(p06(X0Z(@1n(@2n(@2n'L1Y'L/X'L.`'}-i(S-j)d-h-a"},
    {954, 604,
     " .&-a0.-a0.++5Q-a7~-a3,+A8h'L6:'L1`*`0.)y0.'L.&'L"},
    {955, 606,
     " 2z/-8d'L6S'L3&,'.h'L,W'L2&-I16.R0c/6/Q/6.K/6.K0+/f0*290)"},
    {956, 652,
     " -p%*-p-a/t-a/t)m/s)#1H(32x(34V(365)-66*'66-a8:-a8:(t89(U8_(79((79/(79P(=9n(D9n'T9D'H8V'=82'=7H'=6N'e6A(15i'f4"
     "1'=3('=1y'=0B'e/t(1/t%*"},
    {957, 572,
     " 0S'L,f-a.x-a2.(L3L)/4W*+5H*m5M+J5P+f58,<4w,y3f-a5n-a5n-a6V-37*,P7T+q7U+J7T*B6&)D4)(+2d'L"},
    {958, 571,
     " 4$(15N(06C'g7;'=7<&]7;%}6O%T5X%(3j%(3i%N3j%u4R%s5$&-5D&@5E&R5D&m5$''4_'=4$'=-+'=-,)e-++F0l+s-a,)-b-R-a.Z0./)-"
     "n/)-n0+6W0+6W/)/X/)/Y-L/X,F5M,B5M+G/-+R/0)e//(5"},
    {959, 626,
     " 2t,{17,{/@+a/A*V/@)K15(12t(14P(16H)L6I*V6H+`4P,{ 2t-o5T-o8V,+8W*V8V)%5T'=2t'=03'=-/)%-0*V-/,+03-o"},
    {960, 616,
     " ,f-a8`-a8`,_7*,_7*(o7)(J7]()88()8F()8s(,8|(-8|'E8V'=7i'77C'76#'74}'{4~(y4~,_0G,_0G'L.>'L.>,_,f,_"},
    {961, 650,
     " .|,V/]-.1A-]1}-o3~-o69-o9+,%9,*V9+)+69'=3~'=2]'=0_'o0&(F0&%*-|%*-|*P-{+k 6|*V6{+b5-,{3Q,{1s,{0%+b0&*V0%)J1s(/"
     "3Q(/5-(/6{)J"},
    {962, 601,
     " 3M'=0N'=-/)'-0*V-/,)0P-o3I-o4B-o61-]7$-J7$,N6-,e4F,{3Q,{1P,{/@+c/A*V/@)I1P(13M(14w(15n'g6g'=6h&]6g%}5v%T5#%(3"
     "6%(35%N36%u3}%s4K&-4k&@4l&R4k&m4K''4+'="},
    {963, 649,
     " 2t,r13,r0:,9/@+Z/A*V/@)K15(12t(14P(16H)L6I*V6H+W5M,94V,r 2t-a9`-a9`,_7E,_8V+k8W*V8V)%7((15T'=2t'=03'=.b(1-/)%"
     "-0*V-/,+.b,{/y-a"},
    {964, 616,
     " 40(X4T(@5h(@6h(@6h'L5Q'L3P'L2Y'}1a(S1b)d1b,_-$,_-$-a8O-a8O,_3j,_3j)_3i(p"},
    {965, 592,
     " /`-a/`)_/_(u06(T0o(12$(13a(14p)@5P){5b+#5i+W5I,<5+,y3z-a5~-a5~-a6k-27<,P7g+q7h*~7g)X6A(U4X'<1j'=/i'=.`'{-V(Z-"
     "W)d-U-a"},
    {966, 676,
     " 5,,q4F,q4G,&4G(75L(76Q(m7L)@7M*V7L+e6O,B5e,q 5,-e6_-e8*,}9X,59Y*V9X)'8*(16_'@4G'@4G%*2C%*2C'@0/'@.`(1-/)%-0*V"
     "-/,/.`,{/k-V1^-e1^,m0u,b0:,9/=+Z/>*V/=)J0:(l1+(72C(72C,&2B-e"},
    {967, 592,
     " 4&&(2G(3.|%),W%)1E)N/E,+.m,l-,,l,W,l,W-a-A-`05-]0x,c2W*V5~-a8G-a3W);5Y&`6-%{7r%{8G%{8G%*7[%+4g%/"},
    {968, 676,
     " 2C'@/k'R.[('-/(e-0*)-0-a/6-a/6*,/5)+02(a0{(=2C(72C-a4G-a4G(75q(>6Y(a7T)/7U*-7U-a9Y-a9Y*)9X(a80((6o'R4G'@4G%*2"
     "C%*"},
    {969, 858,
     " 2$'=-H'=-I*X-H+u/.-a1A-a/e+u/f*V/e(126(14L(14M+/6C+/6B(18[(1;'(1;(*V;'+u9O-a;b-a=H+u=I*X=H'=8l'=5i'=5I(z4y'="},
    {8211, 512,
     " -$*{62*{62*1-$*1"},
    {8212, 1024,
     " -$*{BU*{BU*1-$*1"},
    {8216, 326,
     " 02-#-p-#-p-|/`/g1,/g02-|"},
    {8217, 326,
     " .l/g10/g10.u/A-.-t-..l.u"},
    {8220, 530,
     " 02-#-p-#-p-|/`/g1,/g02-| 4h-#2G-#2G-|46/g5^/g4h-|"},
    {8221, 530,
     " .h/g1,/g1,.k/<-#-p-#.h.k 3>/g5^/g5^.k3n-#2G-#3>.k"},
    {8230, 1024,
     " 6,(r8M(r8M'L6,'L =b(rA&(rA&'L=b'L .S(r0t(r0t'L.S'L"},
    {8242, 232,
     " ,C-a.:/g0S/g-A-a"},
    {8243, 382,
     " ,C-a.:/g0S/g-A-a /b-a1Y/g3r/g0`-a"},
    {8304, 410,
     " 1a/H/J/H.t.w.=.L.>-P.=,S.t,'/J+W1a+W28,'2k,S2l-P2k.L28.w 0W/u2B/u47.`48-P47,@2B+)0W+).g+),s,@,t-P,s.`.g/u"},
    {8308, 410,
     " 14/.-j,m14,m 0|/m2l/m2l,m4>,m4>,42l,42l+114+114,4,[,4,[,s"},
    {8309, 410,
     " -O/m-N/m30/m30/;.l/;.l.//+.3/K.5/g.70(.71q.72t-m3y-F3z,_3y+v2r+P1k+)/p+)/1+)-i+3-&+;-&+v-a+i.C+a/'+Z/n+Z1'+Z2"
     "N,22N-/1'-d/n-d/7-d.)-Y-O-N"},
    {8310, 410,
     " 0h-g/i-g/4-L.Z-1.[,_.Z,1/4+s/i+W0h+W1c+W2:+s2o,12p,_2o-12:-L1c-g 3Y/e3X/e3Y//3'/92Q/>1y/D1I/D/}/D/8.z.N.S.C-a"
     ".k-z/I.+0'.80n.82J.83E-n4=-F4>,_4=+z3A+R2B+)0h+).s+),w,@,x-P,w.X../8/@/u1C/u1u/u2K/q3#/m"},
    {8311, 410,
     " -,/m-+/m3z/m3z/T0*+1.W+126/;-,/;"},
    {8312, 410,
     " 1X-E/R-E.x-..B,u.C,N.B,'/R+W0W+W1X+W22+n2i,'2i,u22-. /,-_.1-g-b.$-/.=-0.c-//9.{/u2//u3(/W3y/93z.c3y.<3M.$2w-g"
     "1~-_3#-T3^-745,w46,N45+m3<+K2=+)0W+).k+)-r+K,s+m,t,N,s,v-O-7.)-T .W.].V.</,.)/Z-s0W-s1L-s1~.)2R.;2S.]2R.}1~/41"
     "N/H0W/H/]/H/,/4.V.~"},
    {8313, 410,
     " -Q+:-P+:-Q+o.'+e.[+`/1+Z/d+Z1/+Z1v,%2],K2h-=2B-%1b,t1',g0>,g.c,g,o-X,p.@,o/%-l/M.i/u0G/u27/u34/;41.`42-O41,F2"
     "~+g1k+)/j+)/7+).`+-.-+2 0G-71D-72N-m2O.@2N.n1x/,1D/H0G/H/J/H.p/,.9.n.:.@.9-m.p-R/H-7"},
    {8315, 540,
     " -I-J6G-J6G,u-I,u"},
    {8320, 410,
     " 1a+c/J+c.t+5.=*g.>)k.=(n.t(B/J'r1a'r28(B2k(n2l)k2k*g28+5 0W,32B,347*z48)k47(Z2B'D0W'D.g'D,s(Z,t)k,s*z.g,3"},
    {8321, 410,
     " -^((/v((/v+L-I+7-I+s/~,+1Q,+1Q((3j((3j'L-^'L"},
    {8322, 410,
     " .t(*3Y(*3Y'L,z'L,z((-@(7.&(T1q*81r*i1q+.0c+X/h+X/1+X-m+F-$+3-$+s-q,%/B,3/~,31X,33R+L3S*q3R*)/r(P/7(7"},
    {8323, 410,
     " 1f){2g)r3q)93r(m3q(-1i'D/l'D//'D-i'O,~'Y,~(;-V(-.s'|/^'|0o'|21(H22(m21)50y)]/h)].l)].l*7/p*70s*71y*X1z*w1y+80"
     "o+X/l+X/B+X.5+N-A+C-A+}.-,*/T,302,31i,33]+S3^*}3]*Y2]*("},
    {8324, 410,
     " 14+I-j)+14)+ 0|,+2l,+2l)+4>)+4>(O2l(O2l'L14'L14(O,[(O,[)1"},
    {8325, 410,
     " -O,+-N,+30,+30+V.l+V.l*J/+*N/K*P/g*R0(*R1q*R2t*+3y)a3z(y3y(42r'k1k'D/p'D/1'D-i'N-&'V-&(4-a('.C'{/''u/n'u1''u2"
     "N(M2N)J1')~/n)~/7)~.))t-O)i"},
    {8326, 410,
     " 0h*%/i*%/4)g.Z)L.[(y.Z(L/4(1/i'r0h'r1c'r2:(12o(L2p(y2o)L2:)g1c*% 3Y,#3X,#3Y+J3'+T2Q+Y1y+_1I+_/}+_/8+8.N*n.C){"
     ".k*8/I*F0'*S0n*S2J*S3E*,4=)a4>(y4=(83A'm2B'D0h'D.s'D,w(Z,x)k,w*s..+S/@,31C,31u,32K,/3#,+"},
    {8327, 410,
     " -,,+-+,+3z,+3z+o0*'L.W'L26+V-,+V"},
    {8328, 410,
     " 1X)`/R)`.x)I.B)3.C(i.B(B/R'r0W'r1X'r22(,2i(B2i)322)I /,)y.1*%-b*>-/*X-0*}-/+T.{,32/,33(+r3y+T3z*}3y*W3M*>2w*%"
     "1~)y3#)o3^)R45)546(i45(+3<'f2='D0W'D.k'D-r'f,s(+,t(i,s)4-O)R.))o .W*w.V*W/,*D/Z*10W*11L*11~*D2R*V2S*w2R+;1~+O1"
     "N+c0W+c/]+c/,+O.V+<"},
    {8329, 410,
     " -Q'U-P'U-Q(-.'(#.['z/1'u/d'u1/'u1v(@2](f2h)X2B)@1b)21')%0>)%.c)%,o)s,p*Z,o+@-l+h.i,30G,327,334+V41*z42)j41(a2"
     "~(%1k'D/j'D/7'D.`'H.-'M 0G)R1D)R2N*+2O*Z2N+,1x+G1D+c0G+c/J+c.p+G.9+,.:*Z.9*+.p)m/H)R"},
    {8594, 858,
     " =r+;=r*i9Q(X82)9:h*T-4*T-4+P:h+P82,k9Q-L"},
    {8709, 892,
     " :6.u;4/P<G/P:|.]<-.1<t-P=},P=}*D;i(G7q'B5n'B3e'B1j's1/(%0[(9/8'F.('F/z(U/7(w.f)F-]*D-],P/m.N3e/S5n/S7q/S9n/#:"
     "%.y 0t).9<.@9;.@9..D7P.k5n.k4+.k0s-w/z-+/',=/(+J/'*W/z)i0B)H :&.'1U(o1}(_2O(R4+()5n()7P():g(z;`)i<V*W<W+J<V,=;"
     "`-+;#-a"},
    {8722, 858,
     " .>+P<W+P<W*T.>*T"},
    {8730, 652,
     " 8>0a:G0a:G0/9.0/2S'71l'7.:,.,r+s,W,@/f,s2W(x"},
    {8734, 853,
     " 6:)F5w)X5E*'4])F3~)+3/(g1t(g0F(g/G)=.B)u.C*r.B+l/G,J0@,}1v,}2c,}3A,o4#,^4O,@4w,&5E+_6-,@6l,[7X,|8t,|:F,|;E,H<"
     "H+o<I*q<H)w;E)<:J(e8r(e8%(e7M(u6o)& 1j)N3X)N4d*m3;,91j,90_,90*+q/L+J/M*r/L*80*)q0c)N 9$,97B,96**w7L)L9$)L:-)L:"
     "b)q;;*<;<*q;;+N:b+q:',9"},
    {8776, 858,
     " <W*w<W)w;F)O9H)+8A)+7+)+5O)J5D)L5<)N57)N5()R3@)q2>)q1@)q/H)J.>({.>){/N*F1L*j2U*j3i*j5I*L5R*I5Y*H5]*G5n*D7T*%8"
     "W*%9T*%;H*K <W-)<W,*;F+_9H+:8A+:7++:5O+X5D+Z5<+]57+^5(+a3@,#2>,#1@,#/H+X.>+..>,-/N,U1L,y2U,y3i,y5I,Z5P,X5W,W5]"
     ",V5n,R7T,38W,39T,3;H,Z"},
    {8804, 858,
     " <W-+1v+V<W*%<W)'.>++.>,%<W.) .>(G<W(G<W'L.>'L"},
    {8805, 858,
     " .>-+.>.)<W,%<W++.>)'.>*%8~+V <W(G<W'L.>'L.>(G"},
};
/* clang-format on */

#endif

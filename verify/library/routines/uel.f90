! Three user elements of Abaqus's argument list: U1 a truss in space (finite displacements), U2 a plane strain quadrilateral of 2 x 2
! points at small displacements, U3 a bar with a field on degree of freedom 4. The truss refuses
! an increment of time above JPROPS(1)/1000; SVARS(2) counts the increments.
subroutine uel(rhs, amatrx, svars, energy, ndofel, nrhs, nsvars, props, nprops, coords, mcrd, nnode, u, du, v, a, jtype, time, &
  dtime, kstep, kinc, jelem, params, ndload, jdltyp, adlmag, predef, npredf, lflags, mlvarx, ddlmag, mdload, pnewdt, jprops, &
  njprop, period)
  include 'aba_param.inc'
  dimension rhs(mlvarx, *), amatrx(ndofel, ndofel), props(*), svars(*), energy(8), coords(mcrd, nnode), u(ndofel), &
    du(mlvarx, *), v(ndofel), a(ndofel), time(2), params(*), jdltyp(mdload, *), adlmag(mdload, *), ddlmag(mdload, *), &
    predef(2, npredf, nnode), lflags(*), jprops(*)
  rhs(1:ndofel, 1:nrhs) = 0
  amatrx = 0
  select case (jtype)
  case (1)
    call truss(rhs, amatrx, svars, energy, props, coords, u, lflags(2), predef, npredf)
    svars(2) = svars(2) + 1
    if (njprop > 0) then
      if (dtime > jprops(1) / 1000.0d0) pnewdt = 0.5d0
    end if
  case (2)
    call quadrilateral(rhs, amatrx, energy, props, coords, u)
  case default
    call bar_with_field(rhs, amatrx, props, coords, u)
  end select
end subroutine uel

! PROPS: E, A, expansion. The law of T3D2: logarithmic strain, Kirchhoff stress E ln(l/L).
subroutine truss(rhs, amatrx, svars, energy, props, coords, u, nlgeom, predef, npredf)
  include 'aba_param.inc'
  dimension rhs(6), amatrx(6, 6), svars(*), energy(8), props(*), coords(3, 2), u(6), predef(2, npredf, 2)
  dimension d(3), e(3), block(3, 3)
  d = coords(:, 2) - coords(:, 1)
  before = norm2(d)
  if (nlgeom == 1) d = d + u(4:6) - u(1:3)
  distance = norm2(d)
  e = d / distance
  if (nlgeom == 1) then
    strain = log(distance / before)
  else
    strain = dot_product(e, u(4:6) - u(1:3)) / before
  end if
  elastic = strain - props(3) * 0.5d0 * (predef(1, 1, 1) + predef(1, 1, 2))
  force = props(1) * props(2) * elastic
  stiffness = props(1) * props(2) / before
  if (nlgeom == 1) then
    force = force * before / distance
    stiffness = (props(1) * props(2) * before / distance - 2 * force) / distance
  end if
  block = 0
  if (nlgeom == 1) then
    do i = 1, 3
      block(i, i) = force / distance
    end do
  end if
  do i = 1, 3
    block(:, i) = block(:, i) + stiffness * e * e(i)
  end do
  rhs(1:3) = force * e
  rhs(4:6) = -force * e
  amatrx(1:3, 1:3) = block
  amatrx(4:6, 4:6) = block
  amatrx(1:3, 4:6) = -block
  amatrx(4:6, 1:3) = -block
  svars(1) = strain
  energy(2) = 0.5d0 * props(1) * props(2) * before * elastic**2
end subroutine truss

! PROPS: E, nu, thickness.
subroutine quadrilateral(rhs, amatrx, energy, props, coords, u)
  include 'aba_param.inc'
  dimension rhs(8), amatrx(8, 8), energy(8), props(*), coords(2, 4), u(8)
  dimension d(3, 3), b(3, 8), dn(2, 4), jac(2, 2), inverse(2, 2), corner(2, 4)
  real(8) :: jac, inverse
  corner = reshape([-1d0, -1d0, 1d0, -1d0, 1d0, 1d0, -1d0, 1d0], [2, 4])
  d = 0
  d(1:2, 1:2) = props(2)
  d(1, 1) = 1 - props(2)
  d(2, 2) = 1 - props(2)
  d(3, 3) = 0.5d0 - props(2)
  d = d * props(1) / ((1 + props(2)) * (1 - 2 * props(2)))
  do k = 1, 4
    x = corner(1, k) / sqrt(3d0)
    y = corner(2, k) / sqrt(3d0)
    dn(1, :) = 0.25d0 * corner(1, :) * (1 + corner(2, :) * y)
    dn(2, :) = 0.25d0 * corner(2, :) * (1 + corner(1, :) * x)
    jac = matmul(dn, transpose(coords))
    det = jac(1, 1) * jac(2, 2) - jac(1, 2) * jac(2, 1)
    inverse = reshape([jac(2, 2), -jac(2, 1), -jac(1, 2), jac(1, 1)], [2, 2]) / det
    dn = matmul(inverse, dn)
    b = 0
    b(1, 1:7:2) = dn(1, :)
    b(2, 2:8:2) = dn(2, :)
    b(3, 1:7:2) = dn(2, :)
    b(3, 2:8:2) = dn(1, :)
    amatrx = amatrx + props(3) * det * matmul(transpose(b), matmul(d, b))
  end do
  rhs = -matmul(amatrx, u)
  energy(2) = -0.5d0 * dot_product(u, rhs)
end subroutine quadrilateral

! Two nodes with u1 and a field w: E A u' and k w' in series with a coupling c (w - u) of the first equation alone: unsymmetric.
! PROPS: E A/L, k/L, c.
subroutine bar_with_field(rhs, amatrx, props, coords, u)
  include 'aba_param.inc'
  dimension rhs(4), amatrx(4, 4), props(*), coords(*), u(4)
  amatrx(1, 1) = props(1)
  amatrx(3, 3) = props(1)
  amatrx(1, 3) = -props(1)
  amatrx(3, 1) = -props(1)
  amatrx(2, 2) = props(2)
  amatrx(4, 4) = props(2)
  amatrx(2, 4) = -props(2)
  amatrx(4, 2) = -props(2)
  amatrx(3, 4) = amatrx(3, 4) - props(3)
  rhs = -matmul(amatrx, u)
end subroutine bar_with_field

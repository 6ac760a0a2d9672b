!> Unit test of amontons_shape_functions: partition of unity, derivatives, exactness of the rules, faces, extrapolation.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_shape_functions
  use amontons_beam_rules, only: is_beam_kind
  use amontons_kinds, only: DP
  use amontons_shape_functions, only: shape_functions, quadrature, node_coordinates, extrapolation_matrix, facet_shapes, &
    facet_quadrature, facet_node_coordinates, choose_face_rule, MAX_FACET_POINTS
  use amontons_element_kinds, only: element_kind, facet_kind, element_kind_type, facet_kind_type, MAX_ELEMENT_NODES, &
    MAX_ELEMENT_POINTS, &
    MAX_FACE_NODES, N_KINDS, KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D8R, KIND_C3D10, KIND_C3D15, KIND_C3D20, KIND_CSS6, &
    KIND_C3D15_LAYER, &
    KIND_T3D2, KIND_T3D3, KIND_CPS3, KIND_M3D8R, KIND_USER, FAMILY_SOLID, FAMILY_TRUSS, FAMILY_SPRING, FAMILY_MASS, &
    FAMILY_RIGID, FACET_TRI3, is_cohesive, opposite_node, KIND_COH3D6, KIND_COH3D8, &
    FACET_QUAD4, FACET_QUAD8, FACET_LINE2, FACET_LINE3, element_kind_by_name
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: kind

  do kind = 1, N_KINDS
    if (kind == KIND_USER) cycle                 ! its words are in the deck, its functions in UEL
    call check_name(kind)
    if (is_cohesive(kind)) call check_pairs(kind)
    if (n_dims(kind) == 0 .or. is_cohesive(kind)) cycle
    call check_element(kind)
    if (.not. is_beam_kind(kind)) call check_rule(kind)      ! test_beam_rules
    call check_faces(kind)
    if (.not. is_beam_kind(kind)) call check_extrapolation(kind)
  end do
  do kind = KIND_C3D4, KIND_M3D8R
    call check_calculix_rules(kind)
  end do
  do kind = FACET_TRI3, FACET_LINE3
    call check_facet(kind)
    call check_facet_rule(kind)
  end do
  call check_calculix()
  call suite%finish()

contains

  !> Cohesive elements: half of each node of a pair at its point, weights of the face, values of points to their pairs.
  subroutine check_pairs(kind)
    integer, intent(in) :: kind
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), &
      at(3, MAX_ELEMENT_NODES), matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    type(element_kind_type) :: entry
    integer :: n_points, n_nodes, p
    entry = element_kind(kind)
    call quadrature(kind, n_points, xi, w)
    call node_coordinates(kind, at)
    call extrapolation_matrix(kind, matrix, n_nodes, n_points)
    call suite%that(entry%name // 'numbers', n_points == entry%n_points .and. n_nodes == 2 * n_points)
    call suite%near(entry%name // 'weights', sum(w(:n_points)), merge(0.5_DP, merge(4.0_DP, 2.0_DP, kind == KIND_COH3D8), &
      kind == KIND_COH3D6), 1e-15_DP)
    do p = 1, n_points
      call shape_functions(kind, xi(:, p), N, dN)
      call suite%near(entry%name // 'half of each', abs(N(p) - 0.5_DP) + abs(N(opposite_node(kind, p)) - 0.5_DP), 0.0_DP, 1e-15_DP)
      call suite%near(entry%name // 'sum', sum(N) + maxval(abs(sum(dN, dim=2))), 1.0_DP, 1e-15_DP)
      call suite%near(entry%name // 'place', norm2(at(:, p) - xi(:, p)) + norm2(at(:, opposite_node(kind, p)) - xi(:, p)), 0.0_DP, &
        1e-15_DP)
      call suite%near(entry%name // 'extrapolation', sum(matrix(:n_nodes, p)) - matrix(p, p) - matrix(opposite_node(kind, p), p), &
        0.0_DP, 1e-15_DP)
      call suite%near(entry%name // 'its own value', matrix(p, p) * matrix(opposite_node(kind, p), p), 1.0_DP, 1e-15_DP)
    end do
  end subroutine check_pairs


  !> A name is mapped to its kind; two kinds with one name map to the first of them.
  subroutine check_name(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: entry, found
    entry = element_kind(kind)
    found = element_kind(element_kind_by_name(entry%name))
    call suite%that(entry%name // 'is found by its name', found%name == entry%name .and. entry%n_nodes > 0)
    call suite%that(entry%name // 'the first of its name is found', element_kind_by_name(entry%name) <= kind)
  end subroutine check_name


  !> Number of natural coordinates: 3 solids, 2 plane kinds, 1 trusses, 0 the rest.
  pure integer function n_dims(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: entry
    entry = element_kind(kind)
    n_dims = 2
    if (entry%family == FAMILY_SOLID) n_dims = 3
    if (entry%family == FAMILY_TRUSS) n_dims = 1
    if (any(entry%family == [FAMILY_SPRING, FAMILY_MASS, FAMILY_RIGID])) n_dims = 0
  end function n_dims


  !> Values at the nodes, sums, derivatives by differences, the linear field.
  subroutine check_element(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: STEP = 1e-6_DP
    type(element_kind_type) :: entry
    real(DP) :: at(3, MAX_ELEMENT_NODES), xi(3), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), plus(MAX_ELEMENT_NODES), &
      minus(MAX_ELEMENT_NODES), &
      unused(3, MAX_ELEMENT_NODES)
    integer :: a, i
    entry = element_kind(kind)
    call node_coordinates(kind, at)
    do a = 1, entry%n_nodes
      call shape_functions(kind, at(:, a), N, dN)
      N(a) = N(a) - 1
      call suite%near(entry%name // 'one at its node, zero at the others', maxval(abs(N)), 0.0_DP, 1e-15_DP)
    end do
    xi = [0.21_DP, 0.37_DP, -0.43_DP]
    xi(n_dims(kind) + 1:) = 0
    call shape_functions(kind, xi, N, dN)
    call suite%near(entry%name // 'sum of N', sum(N), 1.0_DP, 1e-15_DP)
    call suite%near(entry%name // 'sum of dN', maxval(abs(sum(dN, 2))), 0.0_DP, 3e-15_DP)
    call suite%near(entry%name // 'place', maxval(abs(matmul(at, N) - xi)), 0.0_DP, 1e-15_DP)
    call suite%that(entry%name // 'zero past the nodes', all(abs(N(entry%n_nodes + 1:)) <= 0))
    do i = 1, n_dims(kind)
      xi(i) = xi(i) + STEP
      call shape_functions(kind, xi, plus, unused)
      xi(i) = xi(i) - 2 * STEP
      call shape_functions(kind, xi, minus, unused)
      xi(i) = xi(i) + STEP
      call suite%near(entry%name // 'derivative', maxval(abs((plus - minus) / (2 * STEP) - dN(i, :))), 0.0_DP, 1e-9_DP)
    end do
  end subroutine check_element


  !> The number of points is that of the kind, they lie inside, and all monomials of the rule's degree are exact.
  subroutine check_rule(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: entry
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), approximate
    integer :: n, i, j, k
    entry = element_kind(kind)
    call quadrature(kind, n, xi, w)
    call suite%that(entry%name // 'number of points', n == entry%n_points)
    do k = 0, 5
      do j = 0, 5
        do i = 0, 5
          if (.not. is_exact(kind, i, j, k)) cycle
          approximate = sum(w(:n) * xi(1, :n)**i * xi(2, :n)**j * xi(3, :n)**k)
          call suite%near(entry%name // 'monomial', approximate, exact_integral(kind, i, j, k), 4e-15_DP)
        end do
      end do
    end do
    if (n >= 8 .and. entry%family == FAMILY_SOLID) then
      call suite%that(entry%name // 'xi runs fastest', xi(1, 2) > xi(1, 1) .and. abs(xi(2, 2) - xi(2, 1)) <= 0)
      call suite%that(entry%name // 'zeta runs slowest', xi(3, n) > xi(3, 1) .and. abs(xi(3, 2) - xi(3, 1)) <= 0)
    end if
  end subroutine check_rule


  !> Whether the monomial of these exponents is within the degree of the rule.
  logical function is_exact(kind, i, j, k)
    integer, intent(in) :: kind, i, j, k
    type(element_kind_type) :: entry
    entry = element_kind(kind)
    select case (kind)
    case (KIND_C3D4)
      is_exact = i + j + k <= 1
    case (KIND_C3D6)
      is_exact = i + j <= 1 .and. k <= 3
    case (KIND_C3D15)
      is_exact = i + j <= 2 .and. k <= 5
    case (KIND_CSS6, KIND_C3D15_LAYER)
      is_exact = i + j <= 2 .and. k <= 3
    case (KIND_C3D8R)
      is_exact = max(i, j, k) <= 1
    case (KIND_C3D10)
      is_exact = i + j + k <= 2
    case (KIND_C3D20)
      is_exact = max(i, j, k) <= 5
    case (KIND_CPS3:KIND_M3D8R)
      is_exact = k == 0 .and. is_exact_in_plane(entry, i, j)
    case (KIND_T3D2, KIND_T3D3)
      is_exact = j + k == 0 .and. i <= 2 * entry%n_points - 1
    case default
      is_exact = max(i, j, k) <= 3
    end select
  end function is_exact


  !> The same for the plane kinds.
  logical function is_exact_in_plane(entry, i, j) result(is_exact)
    type(element_kind_type), intent(in) :: entry
    integer, intent(in) :: i, j
    if (is_triangle(entry)) then
      is_exact = i + j <= merge(1, 2, entry%n_points == 1)
    else if (entry%n_points == 10) then            ! two places by Gauss, five heights by Simpson
      is_exact = max(i, j) <= 3
    else
      is_exact = max(i, j) <= 2 * nint(sqrt(real(entry%n_points, DP))) - 1
    end if
  end function is_exact_in_plane


  !> Whether a plane kind or a membrane is a triangle.
  logical function is_triangle(entry)
    type(element_kind_type), intent(in) :: entry
    is_triangle = entry%n_nodes == 3 .or. entry%n_nodes == 6
  end function is_triangle


  !> The integral of xi^i eta^j zeta^k over the parent element.
  real(DP) function exact_integral(kind, i, j, k)
    integer, intent(in) :: kind, i, j, k
    type(element_kind_type) :: entry
    entry = element_kind(kind)
    select case (kind)
    case (KIND_C3D4, KIND_C3D10)
      exact_integral = factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3)
    case (KIND_C3D6, KIND_C3D15, KIND_C3D15_LAYER, KIND_CSS6)
      exact_integral = factorial(i) * factorial(j) / factorial(i + j + 2) * line_integral(k)
    case (KIND_CPS3:KIND_M3D8R)
      exact_integral = line_integral(i) * line_integral(j)
      if (is_triangle(entry)) exact_integral = factorial(i) * factorial(j) / factorial(i + j + 2)
    case (KIND_T3D2, KIND_T3D3)
      exact_integral = line_integral(i)
    case default
      exact_integral = line_integral(i) * line_integral(j) * line_integral(k)
    end select
  end function exact_integral


  real(DP) function factorial(n)
    integer, intent(in) :: n
    factorial = gamma(real(n + 1, DP))
  end function factorial


  real(DP) function line_integral(k)
    integer, intent(in) :: k
    line_integral = 0
    if (mod(k, 2) == 0) line_integral = 2 / real(k + 1, DP)
  end function line_integral


  !> On each face the element's shape functions are those of the facet, and its other nodes' are zero.
  subroutine check_faces(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: entry
    type(facet_kind_type) :: facet
    real(DP) :: at(3, MAX_ELEMENT_NODES), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    real(DP) :: facet_N(MAX_FACE_NODES), facet_dN(2, MAX_FACE_NODES), facet_ddN(3, MAX_FACE_NODES)
    integer :: face
    entry = element_kind(kind)
    call node_coordinates(kind, at)
    do face = 1, entry%n_faces
      facet = facet_kind(entry%face_kind(face))
      call facet_shapes(entry%face_kind(face), [0.3_DP, merge(0.45_DP, 0.0_DP, n_dims(kind) == 3)], facet_N, facet_dN, facet_ddN)
      associate (nodes => entry%face_nodes(:facet%n_nodes, face))
        call shape_functions(kind, matmul(at(:, nodes), facet_N(:facet%n_nodes)), N, dN)
        call suite%near(entry%name // 'face and facet', maxval(abs(N(nodes) - facet_N(:facet%n_nodes))), 0.0_DP, &
          1e-15_DP)
        N(nodes) = 0
      end associate
      call suite%near(entry%name // 'nodes off the face', maxval(abs(N)), 0.0_DP, 1e-15_DP)
    end do
  end subroutine check_faces


  !> Linear fields are exact at every node, constants for the one-point tetrahedron.
  subroutine check_extrapolation(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: entry
    real(DP) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS), xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), at(3, &
      MAX_ELEMENT_NODES), field(3, MAX_ELEMENT_NODES)
    integer :: n_nodes, n_points, n
    entry = element_kind(kind)
    call extrapolation_matrix(kind, matrix, n_nodes, n_points)
    call quadrature(kind, n, xi, w)
    call node_coordinates(kind, at)
    call suite%that(entry%name // 'size of the extrapolation', &
      n_nodes == entry%n_nodes .and. n_points == entry%n_points)
    call suite%near(entry%name // 'extrapolates a constant', maxval(abs(sum(matrix(:n_nodes, :), 2) - 1)), 0.0_DP, &
      1e-13_DP)
    if (entry%n_points == 1) return
    field = matmul(xi, transpose(matrix))
    if (kind == KIND_C3D6) then
      field(:2, :) = 0                            ! two points do not resolve xi and eta
      at(:2, :) = 0
    end if
    call suite%near(entry%name // 'extrapolates a linear field', maxval(abs(field - at)), 0.0_DP, 1e-13_DP)
  end subroutine check_extrapolation


  !> The coefficients agree with CalculiX's output, to its printed digits.
  subroutine check_calculix()
    real(DP) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    integer :: n_nodes, n_points
    call extrapolation_matrix(KIND_C3D8, matrix, n_nodes, n_points)
    call suite%near('C3D8: nearest point', matrix(1, 1), 2.549_DP, 5e-4_DP)
    call suite%near('C3D8: third point belongs to node 4', matrix(4, 3), 2.549_DP, 5e-4_DP)
    call suite%near('C3D8: farthest point', matrix(7, 1), -0.04904_DP, 5e-5_DP)
    call extrapolation_matrix(KIND_C3D20, matrix, n_nodes, n_points)
    call suite%near('C3D20: nearest point', matrix(1, 1), 2.37499_DP, 5e-6_DP)
    call suite%near('C3D20: farthest point', matrix(7, 1), 0.11575_DP, 5e-6_DP)
    call suite%near('C3D20: mid-side', matrix(9, 1), 0.32628_DP, 5e-6_DP)
    call extrapolation_matrix(KIND_C3D15, matrix, n_nodes, n_points)
    call suite%near('C3D15: nearest point', matrix(1, 1), 1.63138_DP, 5e-6_DP)
    call suite%near('C3D15: next point', matrix(1, 2), -0.32628_DP, 5e-6_DP)
  end subroutine check_calculix


  !> Values at the nodes, sums, first and second derivatives by differences.
  subroutine check_facet(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: STEP = 1e-6_DP
    type(facet_kind_type) :: entry
    real(DP) :: at(2, MAX_FACE_NODES), xi(2), N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    real(DP) :: Np(MAX_FACE_NODES), dNp(2, MAX_FACE_NODES), Nm(MAX_FACE_NODES), dNm(2, MAX_FACE_NODES), &
      unused(3, MAX_FACE_NODES)
    integer :: a, i
    entry = facet_kind(kind)
    call facet_node_coordinates(kind, at)
    do a = 1, entry%n_nodes
      call facet_shapes(kind, at(:, a), N, dN, ddN)
      N(a) = N(a) - 1
      call suite%near('facet: one at its node', maxval(abs(N)), 0.0_DP, 1e-15_DP)
    end do
    xi = [0.21_DP, 0.37_DP]
    if (kind >= FACET_LINE2) xi(2) = 0
    call facet_shapes(kind, xi, N, dN, ddN)
    call suite%near('facet: sum of N', sum(N), 1.0_DP, 1e-15_DP)
    call suite%near('facet: place', maxval(abs(matmul(at, N) - xi)), 0.0_DP, 1e-15_DP)
    do i = 1, merge(1, 2, kind >= FACET_LINE2)
      xi(i) = xi(i) + STEP
      call facet_shapes(kind, xi, Np, dNp, unused)
      xi(i) = xi(i) - 2 * STEP
      call facet_shapes(kind, xi, Nm, dNm, unused)
      xi(i) = xi(i) + STEP
      call suite%near('facet: derivative', maxval(abs((Np - Nm) / (2 * STEP) - dN(i, :))), 0.0_DP, 1e-9_DP)
      dNp = (dNp - dNm) / (2 * STEP)
      call suite%near('facet: second derivative', maxval(abs(dNp(i, :) - ddN(i, :))), 0.0_DP, 1e-9_DP)
      call suite%near('facet: mixed derivative', maxval(abs(dNp(3 - i, :) - ddN(3, :))), 0.0_DP, 1e-9_DP)
    end do
  end subroutine check_facet


  !> CalculiX's rules of the faces: constants and linear functions are exact, with the least number of points.
  subroutine check_calculix_rules(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: entry
    real(DP) :: xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS), own_w(MAX_FACET_POINTS), own_xi(2, MAX_FACET_POINTS)
    integer :: face, n, own
    entry = element_kind(kind)
    do face = 1, entry%n_faces
      call facet_quadrature(choose_face_rule(kind, entry%face_kind(face), .true.), n, xi, w)
      call facet_quadrature(entry%face_kind(face), own, own_xi, own_w)
      call suite%that('no more points than the own rule', n <= own .and. n >= 1)
      call suite%near('weights', sum(w), sum(own_w), 1e-14_DP)
      call suite%near('linear functions', maxval(abs(matmul(xi, w) - matmul(own_xi, own_w))), 0.0_DP, 1e-14_DP)
    end do
  end subroutine check_calculix_rules


  !> All monomials within the degree of the rule are exact.
  subroutine check_facet_rule(kind)
    integer, intent(in) :: kind
    real(DP) :: xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS), approximate
    integer :: n, i, j
    integer, parameter :: DEGREE(6) = [2, 3, 4, 5, 3, 5]
    call facet_quadrature(kind, n, xi, w)
    do j = 0, 5
      do i = 0, 5
        approximate = sum(w(:n) * xi(1, :n)**i * xi(2, :n)**j)
        if (kind >= FACET_LINE2) then
          if (j > 0 .or. i > DEGREE(kind)) cycle
          call suite%near('edge rule', approximate, line_integral(i), 1e-15_DP)
        else if (kind == FACET_QUAD4 .or. kind == FACET_QUAD8) then
          if (max(i, j) > DEGREE(kind)) cycle
          call suite%near('square rule', approximate, line_integral(i) * line_integral(j), 1e-15_DP)
        else if (i + j <= DEGREE(kind)) then
          call suite%near('triangle rule', approximate, factorial(i) * factorial(j) / factorial(i + j + 2), 1e-15_DP)
        end if
      end do
    end do
  end subroutine check_facet_rule

end program test_shape_functions

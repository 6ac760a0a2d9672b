!> Unit test of beam_cross_sections: published figures of an angle and a channel, Saint-Venant's torsion, cells, branches.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_beam_cross_sections
  use amontons_kinds, only: DP, PI
  use amontons_beam_cross_sections, only: cross_section_type, i_section, box_section, l_section, hexagon_section, &
    trapezoid_section, wall_section, WALLS_OK, WALLS_LOOSE, WALLS_CELLS, WALLS_LINE
  use check, only: suite_type
  implicit none
  real(DP), parameter :: ROUNDING = 1.0e-13_DP
  type(suite_type) :: suite
  call check_angle()
  call check_i()
  call check_hexagon()
  call check_trapezoid()
  call check_channel()
  call check_branches()
  call check_cells()
  call check_refusals()
  call suite%finish()

contains

  !> Walls that must be right.
  function walls(points, thickness) result(section)
    real(DP), intent(in) :: points(:, :), thickness(:)
    type(cross_section_type) :: section
    integer :: status
    call wall_section(points, thickness, section, status)
    call suite%that('walls', status == WALLS_OK)
  end function walls


  !> L 120 x 80 x 10 without fillets: area 1900; its moments of inertia as outer rectangle less the empty one; Iu and Iv of equal
  !! legs are b^3 t/3 and b^3 t/12 of thin ones (S. Timoshenko, Strength of Materials II); J = (a + b - t) t^3/3.
  subroutine check_angle()
    type(cross_section_type) :: L
    real(DP) :: place(2), about(2), product
    L = l_section([80.0_DP, 120.0_DP], [10.0_DP, 10.0_DP])
    call suite%near('area', L%area, 1900.0_DP, ROUNDING)
    place = ([40.0_DP, 60.0_DP] * 9600 - [45.0_DP, 65.0_DP] * 7700) / 1900   ! from the outer corner
    call suite%near('centroid', norm2(L%centroid + 5 - place), 0.0_DP, 1.0e-12_DP)
    about = [80 * 120.0_DP**3 - 70 * 110.0_DP**3, 120 * 80.0_DP**3 - 110 * 70.0_DP**3] / 12 + 9600 * (place([2, 1]) - &
      [60.0_DP, 40.0_DP])**2 - 7700 * (place([2, 1]) - [65.0_DP, 45.0_DP])**2
    call suite%near('moments of inertia', maxval(abs(L%about / about - 1)), 0.0_DP, ROUNDING)
    product = 9600 * (40 - place(1)) * (60 - place(2)) - 7700 * (45 - place(1)) * (65 - place(2))
    call suite%near('product of inertia', L%product / product, 1.0_DP, ROUNDING)
    call suite%near('J', L%torsion, 190 * 1000.0_DP / 3, 1.0e-10_DP)
    call suite%near('shear centre at the node', norm2(L%shear_center), 0.0_DP, 0.0_DP)
    L = l_section([1.0_DP, 1.0_DP], [1.0e-5_DP, 1.0e-5_DP])
    call suite%near('strong axis of thin equal legs', (L%about(1) - L%product) / (1.0e-5_DP / 3), 1.0_DP, 3.0e-5_DP)   ! order t/b
    call suite%near('weak axis', (L%about(1) + L%product) / (1.0e-5_DP / 12), 1.0_DP, 3.0e-5_DP)
  end subroutine check_angle


  !> An uneven I: the shear centre divides the distance of the flanges by their moments of inertia (Timoshenko, Strength of
  !! Materials I, section 52); a T has it in its flange.
  subroutine check_i()
    type(cross_section_type) :: I, upside
    real(DP) :: stiff(2)
    I = i_section(0.0_DP, 10.0_DP, [6.0_DP, 4.0_DP], [1.0_DP, 2.0_DP], 0.5_DP)
    stiff = [1 * 6.0_DP**3, 2 * 4.0_DP**3]
    call suite%near('shear centre of an I', norm2(I%shear_center - [0.0_DP, sum(stiff * [0.5_DP, 9.0_DP]) / sum(stiff)]), 0.0_DP, &
      1.0e-12_DP)
    I = i_section(3.0_DP, 10.0_DP, [0.0_DP, 4.0_DP], [0.0_DP, 2.0_DP], 0.5_DP)
    call suite%near('area of a T', I%area, 12.0_DP, ROUNDING)
    call suite%near('shear centre of a T', norm2(I%shear_center - [0.0_DP, 6.0_DP]), 0.0_DP, 1.0e-12_DP)
    call suite%near('centroid of a T', norm2(I%centroid - [0.0_DP, 52 / 12.0_DP]), 0.0_DP, 1.0e-12_DP)
    upside = i_section(7.0_DP, 10.0_DP, [4.0_DP, 0.0_DP], [2.0_DP, 0.0_DP], 0.5_DP)
    call suite%near('T upside down', norm2(upside%centroid + I%centroid) + norm2(upside%about - I%about), 0.0_DP, 1.0e-12_DP)
  end subroutine check_i


  !> A thin hexagon against its middle line of length 6 R: A = 6 R t, I = 5/2 R^3 t, J = 4 A^2/(6 R/t); a hole that vanishes.
  subroutine check_hexagon()
    type(cross_section_type) :: H, walls_of
    real(DP) :: R, points(2, 7)
    integer :: k
    H = hexagon_section(10.0_DP, 1.0e-4_DP)
    R = 10 - 1.0e-4_DP / sqrt(3.0_DP)
    call suite%near('area', H%area, 6 * R * 1.0e-4_DP, 1.0e-12_DP)   ! a difference of squares of 100
    call suite%near('I', H%about(1) / (2.5_DP * R**3 * 1.0e-4_DP), 1.0_DP, 1.0e-9_DP)   ! order (t/R)^2
    do k = 1, 7
      points(:, k) = R * [cos(real(k, DP) * PI / 3), sin(real(k, DP) * PI / 3)]
    end do
    walls_of = walls(points, [(1.0e-4_DP, k=1, 6)])
    call suite%near('J as walls', H%torsion / walls_of%torsion, 1.0_DP, 1.0e-12_DP)
    call suite%near('I as walls', maxval(abs(walls_of%about / H%about - 1)), 0.0_DP, 1.0e-9_DP)
    call suite%near('its centre', norm2(walls_of%shear_center), 0.0_DP, 1.0e-12_DP)
    H = hexagon_section(2.0_DP, sqrt(3.0_DP))
    call suite%near('full hexagon', H%about(2), 5 * sqrt(3.0_DP), 1.0e-12_DP)
  end subroutine check_hexagon


  !> A rectangle: J = a b^3 (1/3 - 64/pi^5 b/a sum tanh(n pi a/(2 b))/n^5), n odd (Timoshenko, Goodier, section 109); nearly an
  !! equilateral triangle: J = sqrt(3)/80 side^4 (section 107); moments of inertia of a triangle.
  subroutine check_trapezoid()
    type(cross_section_type) :: S
    real(DP) :: series, ratio(2)
    integer :: n, k
    ratio = [1.0_DP, 3.0_DP]
    do k = 1, 2
      S = trapezoid_section(2.0_DP, 2 * ratio(k), 2.0_DP, 0.0_DP)
      series = 0
      do n = 1, 61, 2
        series = series + tanh(real(n, DP) * PI * ratio(k) / 2) / real(n, DP)**5
      end do
      call suite%near('torsion of a rectangle', S%torsion / (16 * ratio(k) * (1 - 192 / PI**5 / ratio(k) * series) / 3), 1.0_DP, &
        1.0e-6_DP)                                   ! Ritz: right angles leave r^2 log r
    end do
    call suite%near('rectangle', norm2(S%about - [2 * 6.0_DP**3, 6 * 2.0_DP**3] / 12), 0.0_DP, 1.0e-12_DP)
    S = trapezoid_section(2.0_DP, sqrt(3.0_DP), 1.0e-6_DP, 0.0_DP)
    call suite%near('torsion of a triangle', S%torsion / (sqrt(3.0_DP) / 5), 1.0_DP, 1.0e-5_DP)   ! the width at the top
    call suite%near('triangle', maxval(abs(S%about/[2 * sqrt(3.0_DP)**3 / 36, 8 * sqrt(3.0_DP) / 48] - 1)), 0.0_DP, 1.0e-5_DP)
    call suite%near('its centroid', S%centroid(2), 1 / sqrt(3.0_DP), 1.0e-6_DP)
    S = trapezoid_section(3.0_DP, 2.0_DP, 1.0_DP, 0.5_DP)
    call suite%near('centroid from the node', S%centroid(2), 2 * 5 / 12.0_DP - 0.5_DP, ROUNDING)
    call suite%near('turned over', trapezoid_torsion_of(1.0_DP, 3.0_DP) / S%torsion, 1.0_DP, 1.0e-12_DP)
  end subroutine check_trapezoid


  !> J of a trapezoid of height 2.
  real(DP) function trapezoid_torsion_of(bottom, top) result(torsion)
    real(DP), intent(in) :: bottom, top
    type(cross_section_type) :: S
    S = trapezoid_section(bottom, 2.0_DP, top, 0.0_DP)
    torsion = S%torsion
  end function trapezoid_torsion_of


  !> A channel: the shear centre lies b^2 h^2 t/(4 I) behind the web (Timoshenko, Strength of Materials I, section 52).
  subroutine check_channel()
    type(cross_section_type) :: C
    real(DP), parameter :: B = 3, H = 8, T = 0.1_DP, W = 0.2_DP
    real(DP) :: about
    C = walls(reshape([B, -H / 2, 0.0_DP, -H / 2, 0.0_DP, H / 2, B, H / 2], [2, 4]) + 1, [T, W, T])
    about = W * H**3 / 12 + 2 * B * T * (H / 2)**2
    call suite%near('channel: I', C%about(1), about, 1.0e-12_DP)
    call suite%near('channel: shear centre', norm2(C%shear_center - 1 - [-B**2 * H**2 * T / (4 * about), 0.0_DP]), 0.0_DP, &
      1.0e-12_DP)
    call suite%near('channel: centroid', norm2(C%centroid - 1 - [B**2 * T / (2 * B * T + H * W), 0.0_DP]), 0.0_DP, 1.0e-12_DP)
    call suite%near('channel: J', C%torsion, (2 * B * T**3 + H * W**3) / 3, ROUNDING)
  end subroutine check_channel


  !> An I as a path that goes back along half flanges is that of thin walls; so is an L.
  subroutine check_branches()
    type(cross_section_type) :: P, I, L
    real(DP), parameter :: T = 1.0e-6_DP
    I = i_section(0.0_DP, 10.0_DP, [6.0_DP, 4.0_DP], [T, 2 * T], T)
    P = walls(reshape([-3.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 3.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 10.0_DP, -2.0_DP, 10.0_DP, &
      0.0_DP, 10.0_DP, 2.0_DP, 10.0_DP], [2, 8]), [T, T, 0.0_DP, T, 2 * T, 0.0_DP, 2 * T])
    call suite%near('branches: I', maxval(abs(P%about / I%about - 1)), 0.0_DP, 1.0e-6_DP)   ! order t/h
    call suite%near('branches: J', P%torsion / I%torsion, 1.0_DP, 1.0e-6_DP)
    call suite%near('branches: shear centre', norm2(P%shear_center - I%shear_center), 0.0_DP, 1.0e-5_DP)
    L = l_section([3.0_DP, 4.0_DP], [T, T])
    P = walls(reshape([3.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 4.0_DP], [2, 3]), [T, T])
    call suite%near('angle: shear centre', norm2(P%shear_center), 0.0_DP, 1.0e-12_DP)
    call suite%near('angle: product', P%product / L%product, 1.0_DP, 2.0e-6_DP)
  end subroutine check_branches


  !> A box as four walls; its shear centre, with one wall thick, lies on the axis of symmetry where a force along the walls does not
  !! twist: the shear flow is found here from equilibrium and zero twist.
  subroutine check_cells()
    type(cross_section_type) :: P, X
    real(DP), parameter :: B = 4, H = 6, T = 1.0e-3_DP
    real(DP) :: about, q0, twist, moment, top, e
    P = walls(reshape([0.0_DP, 0.0_DP, B, 0.0_DP, B, H, 0.0_DP, H, 0.0_DP, 0.0_DP], [2, 5]), [T, 3 * T, T, T])
    call suite%near('cell: J', P%torsion, 4 * (B * H)**2 / (2 * B / T + H / T + H / (3 * T)), 1.0e-14_DP)
    about = 4 * T * H**3 / 12 + 2 * B * T * (H / 2)**2
    call suite%near('cell: I', P%about(1) / about, 1.0_DP, ROUNDING)
    ! cut at the middle of the left wall; flow of a unit force along the right wall: q = -(first moment)/I, counter-clockwise
    ! left wall from its middle down, bottom to the right, right wall up, symmetric
    top = T * (H / 2)**2 / 2                       ! first moment of half the left wall
    twist = 2 * (T * (H / 2)**3 / 6) / T + 2 * (top * B + T * H / 2 * B**2 / 2) / T   ! int q ds/t, left and bottom with top
    twist = twist + ((top + T * H / 2 * B) * H + 3 * T * (H**3 / 12)) / (3 * T)
    q0 = -twist / (2 * B / T + H / T + H / (3 * T))
    ! moment about the lower left corner: right wall at distance B, top wall at distance H
    moment = B * ((top + T * H / 2 * B) * H + 3 * T * H**3 / 12) + H * (top * B + T * H / 2 * B**2 / 2) + q0 * 2 * B * H
    e = moment / about
    call suite%near('cell: shear centre', norm2(P%shear_center - [e, H / 2]), 0.0_DP, 1.0e-12_DP)
    X = box_section([B + 2 * T, H + T], [3 * T, T], [T, T])
    call suite%near('box: shear centre', norm2(X%shear_center + [(B + 2 * T) / 2 - T / 2, H / 2] - [e, H / 2]), 0.0_DP, 1.0e-12_DP)
    X = box_section([4.0_DP, 6.0_DP], [0.2_DP, 0.3_DP], [0.2_DP, 0.3_DP])
    call suite%near('even box', norm2(X%shear_center), 0.0_DP, ROUNDING)
  end subroutine check_cells


  !> A bridge of no thickness, a cell with a fin, two cells, all walls on a line.
  subroutine check_refusals()
    real(DP), parameter :: SQUARE(2, 5) = reshape([0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 1.0_DP, 1.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, &
      0.0_DP], [2, 5])
    type(cross_section_type) :: section
    integer :: status
    call wall_section(SQUARE(:, :4), [1.0_DP, 0.0_DP, 1.0_DP], section, status)
    call suite%that('loose', status == WALLS_LOOSE)
    call wall_section(reshape([SQUARE, 0.0_DP, -1.0_DP], [2, 6]), [1.0_DP, 1.0_DP, 1.0_DP, 1.0_DP, 1.0_DP], section, status)
    call suite%that('fin', status == WALLS_CELLS)
    call wall_section(reshape([SQUARE, 1.0_DP, 1.0_DP], [2, 6]), [1.0_DP, 1.0_DP, 1.0_DP, 1.0_DP, 1.0_DP], section, status)
    call suite%that('two cells', status == WALLS_CELLS)
    call wall_section(reshape([0.0_DP, 0.0_DP, 1.0_DP, 1.0_DP, 3.0_DP, 3.0_DP], [2, 3]), [1.0_DP, 2.0_DP], section, status)
    call suite%that('line', status == WALLS_LINE)
  end subroutine check_refusals

end program test_beam_cross_sections

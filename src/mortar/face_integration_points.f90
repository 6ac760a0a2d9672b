!> Facing: where two surfaces face each other: slave faces cut with master faces, and seven points in each triangle of a cut.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Springs at points". The corners of a slave face, mid-side nodes among them, and those of the
!! master faces in front of it are projected on a plane across the mean normal of the slave face and cut with each other. A cut is
!! divided into triangles about the mean of its corners, in the natural coordinates of the slave face, and each triangle takes a
!! rule of seven points that is exact for degree 5 (J. Radon, Monatsh. Math. 52 (1948) 286-300). A point faces the point of the
!! master face that is nearest to it.
!!
!! A line of the plane is drawn out into a face of depth 1, or of a wedge of two degrees where it is the full circle, so that it is
!! cut as the solid that CalculiX makes of it.
module amontons_face_integration_points
  use amontons_kinds, only: DP, PI
  use amontons_tensor, only: cross_product
  use amontons_topology, only: FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, FACET_LINE2, MAX_FACE_NODES
  use amontons_shape_functions, only: facet_shapes, facet_node_coordinates
  use amontons_facets, only: facets_type, facet_nodes, facet_tangents, is_line
  use amontons_facet_search, only: search_type, near_facets
  use amontons_polygon_clipping, only: place_on_flat, clip_polygon, polygon_area, MAX_CORNERS
  implicit none
  private
  public :: facing_type, find_facing, face_normal

  real(DP), parameter :: FACING = 0.2_DP           !< a master face is in front if its normal is this much against the slave's [-]
  real(DP), parameter :: SLIVER = 1.0e-10_DP       !< cuts smaller than this part of the face are nothing [-]
  real(DP), parameter :: OVERLAP = 1.0e-6_DP       !< cuts that overlap by more of the face lie one behind the other [-]
  integer, parameter :: MOST_ITERATIONS = 30       !< of Newton for the natural coordinates of a point
  real(DP), parameter :: LEAST = 1.0e-4_DP     !< triangles with less area in natural coordinates are left out, as CalculiX does [-]
  real(DP), parameter :: HALF_WEDGE = PI / 180     !< of the solid that CalculiX makes of an axisymmetric element [rad]
  integer, parameter :: N_RULE = 7                 !< points in a triangle

  !> One point of a slave face and what it faces.
  type :: facing_type
    integer :: slave = 0                           !< facet
    integer :: master = 0                          !< facet
    real(DP) :: at(2) = 0                 !< natural coordinates on the slave facet; of a line the second one is along its depth [-]
    real(DP) :: xi(2) = 0                          !< natural coordinates on the master facet [-]
    real(DP) :: area = 0                           !< [length^2]
  end type facing_type

  !> A face in space.
  type :: sheet_type
    integer :: kind = 0                            !< FACET_... of a face with area
    integer :: n = 0                               !< nodes
    integer :: first = 1                           !< corner at which its outline begins, as CalculiX numbers its faces
    real(DP) :: x(3, MAX_FACE_NODES) = 0           !< [length]
    real(DP) :: origin(3) = 0                      !< of the plane through it [length]
    real(DP) :: axes(3, 2) = 0                     !< unit vectors in the plane
    real(DP) :: normal(3) = 0                      !< mean unit normal
  end type sheet_type

  !> A part of a slave face that faces one master face.
  type :: cut_type
    integer :: master = 0                          !< facet
    integer :: n = 0                               !< corners
    real(DP) :: corners(2, MAX_CORNERS) = 0        !< in the plane of the slave face [length]
    real(DP) :: distance = 0                       !< of its middle from the master face, along the normal [length]
  end type cut_type

contains

  !> All points of a slave surface that face a master, slave facet by slave facet. Cost: linear in the cuts.
  subroutine find_facing(slave, depth, master, search, x, reach, points, n)
    type(facets_type), intent(in) :: slave, master
    real(DP), intent(in) :: depth(:)               !< (slave%n) of lines: thickness [length], -1: the full circle; else 1
    type(search_type), intent(in) :: search        !< of the master's facets, its margin reaches from the middle of a slave facet
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    real(DP), intent(in) :: reach                  !< facets farther apart do not see each other [length]
    type(facing_type), allocatable, intent(out) :: points(:)   !< the first n are set
    integer, intent(out) :: n
    type(sheet_type) :: sheet, front
    type(cut_type), allocatable :: cuts(:)
    integer, allocatable :: list(:)
    integer :: f, k, n_list, n_cuts
    allocate (points(64), cuts(16))
    n = 0
    do f = 1, slave%n
      call lay_sheet(slave, f, x, depth(f), sheet)
      call near_facets(search, sheet%origin, list, n_list)
      call sort_facets(master, list(:n_list))
      n_cuts = 0
      do k = 1, n_list
        call lay_sheet(master, list(k), x, depth(f), front)
        call cut_with(sheet, front, list(k), reach, cuts, n_cuts)
      end do
      call drop_behind(sheet, cuts, n_cuts)
      do k = 1, n_cuts
        if (cuts(k)%n < 3) cycle
        call lay_sheet(master, cuts(k)%master, x, depth(f), front)
        call add_points(sheet, f, is_line(slave%kind(f)), depth(f), front, cuts(k), points, n)
      end do
    end do
  end subroutine find_facing


  !> A facet as a sheet, with the plane through the mean of its nodes across the mean of its unit normals there.
  pure subroutine lay_sheet(facets, f, x, depth, sheet)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                       !< facet
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: depth                  !< of a line: negative is the full circle
    type(sheet_type), intent(out) :: sheet
    real(DP) :: xi(2, MAX_FACE_NODES), tangents(3, 2), v(3)
    integer :: i, nodes(MAX_FACE_NODES)
    call facet_nodes(facets, f, sheet%n, nodes)
    sheet%kind = facets%kind(f)
    if ((sheet%kind == FACET_QUAD4 .or. sheet%kind == FACET_QUAD8) .and. facets%face(f) == 1) sheet%first = 2
    if ((sheet%kind == FACET_TRI3 .or. sheet%kind == FACET_TRI6) .and. facets%face(f) == 4) sheet%first = 2
    sheet%x(:, :sheet%n) = x(:, nodes(:sheet%n))
    if (is_line(sheet%kind)) call draw_out(sheet, depth < 0.0_DP)
    call facet_node_coordinates(sheet%kind, xi)
    do i = 1, sheet%n
      tangents = tangents_at(sheet, xi(:, i))
      v = cross_product(tangents(:, 1), tangents(:, 2))
      sheet%normal = sheet%normal + v / max(norm2(v), tiny(1.0_DP))
    end do
    sheet%normal = sheet%normal / max(norm2(sheet%normal), tiny(1.0_DP))
    sheet%origin = sum(sheet%x(:, :sheet%n), dim=2) / real(sheet%n, DP)
    v = sheet%x(:, 2) - sheet%x(:, 1)
    v = v - dot_product(sheet%normal, v) * sheet%normal
    sheet%axes(:, 1) = v / max(norm2(v), tiny(1.0_DP))
    sheet%axes(:, 2) = cross_product(sheet%normal, sheet%axes(:, 1))
  end subroutine lay_sheet


  !> A line becomes a face of depth 1, or of the wedge's; its first natural coordinate stays.
  pure subroutine draw_out(sheet, is_wedge)
    type(sheet_type), intent(inout) :: sheet
    logical, intent(in) :: is_wedge
    real(DP) :: line(3, 3), half(3)
    line = sheet%x(:, :3)
    half = 0.5_DP
    if (is_wedge) half = sin(HALF_WEDGE) * line(1, :)
    if (sheet%kind == FACET_LINE2) then
      sheet%kind = FACET_QUAD4
      sheet%n = 4
    else
      sheet%kind = FACET_QUAD8
      sheet%n = 8
      sheet%x(:, 5:8) = line(:, [3, 2, 3, 1])
      sheet%x(3, 5:8) = [-half(3), 0.0_DP, half(3), 0.0_DP]
    end if
    sheet%x(:, :4) = line(:, [1, 2, 2, 1])
    sheet%x(3, :4) = [-half(1), -half(2), half(2), half(1)]
  end subroutine draw_out


  !> The tangents of a sheet at natural coordinates.
  pure function tangents_at(sheet, xi) result(tangents)
    type(sheet_type), intent(in) :: sheet
    real(DP), intent(in) :: xi(2)                  !< [-]
    real(DP) :: tangents(3, 2)                     !< [length]
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    call facet_shapes(sheet%kind, xi, N, dN, ddN)
    tangents = matmul(sheet%x(:, :sheet%n), transpose(dN(:, :sheet%n)))
  end function tangents_at


  !> A point of a sheet.
  pure function point_at(sheet, xi) result(point)
    type(sheet_type), intent(in) :: sheet
    real(DP), intent(in) :: xi(2)                  !< [-]
    real(DP) :: point(3)                           !< [length]
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    call facet_shapes(sheet%kind, xi, N, dN, ddN)
    point = matmul(sheet%x(:, :sheet%n), N(:sheet%n))
  end function point_at


  !> The nodes around a face in their order: each corner and the mid-side node behind it.
  pure function outline_of(sheet) result(outline)
    type(sheet_type), intent(in) :: sheet
    integer, allocatable :: outline(:)
    select case (sheet%kind)
    case (FACET_TRI3)
      outline = [1, 2, 3]
    case (FACET_QUAD4)
      outline = [1, 2, 3, 4]
    case (FACET_TRI6)
      outline = [1, 4, 2, 5, 3, 6]
    case default
      outline = [1, 5, 2, 6, 3, 7, 4, 8]
    end select
    outline = cshift(outline, (sheet%first - 1) * merge(2, 1, sheet%n > 4))
  end function outline_of


  !> The convex pieces of a master face in the plane: a quadratic face has one at each corner and one in the middle.
  pure subroutine list_pieces(kind, pieces, n)
    integer, intent(in) :: kind                    !< FACET_... of a face with area
    integer, intent(out) :: pieces(4, 5)           !< local nodes; 0 as the fourth: a triangle
    integer, intent(out) :: n
    pieces = 0
    select case (kind)
    case (FACET_TRI3)
      n = 1
      pieces(:3, 1) = [1, 2, 3]
    case (FACET_QUAD4)
      n = 1
      pieces(:, 1) = [1, 2, 3, 4]
    case (FACET_TRI6)
      n = 4
      pieces(:3, :4) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3, 4, 5, 6], [3, 4])
    case default
      n = 5
      pieces = reshape([1, 5, 8, 0, 5, 2, 6, 0, 6, 3, 7, 0, 7, 4, 8, 0, 5, 6, 7, 8], [4, 5])
    end select
  end subroutine list_pieces


  !> Local nodes of a face counted from the corner at which its outline begins.
  pure function as_numbered(sheet, nodes) result(numbered)
    type(sheet_type), intent(in) :: sheet
    integer, intent(in) :: nodes(:)                !< corners, then mid-sides
    integer :: numbered(size(nodes))
    integer :: m
    m = merge(3, 4, sheet%kind == FACET_TRI3 .or. sheet%kind == FACET_TRI6)
    numbered = merge(modulo(nodes + sheet%first - 2, m) + 1, m + modulo(nodes - m + sheet%first - 2, m) + 1, nodes <= m)
  end function as_numbered


  !> Facets in the order of their elements and faces.
  pure subroutine sort_facets(facets, list)
    type(facets_type), intent(in) :: facets
    integer, intent(inout) :: list(:)
    integer :: i, k, f
    do i = 2, size(list)
      f = list(i)
      do k = i - 1, 1, -1
        if (facets%element(list(k)) < facets%element(f)) exit
        if (facets%element(list(k)) == facets%element(f) .and. facets%face(list(k)) <= facets%face(f)) exit
        list(k + 1) = list(k)
      end do
      list(k + 1) = f
    end do
  end subroutine sort_facets


  !> Appends the cuts of a slave face with the pieces of one master face.
  subroutine cut_with(sheet, front, g, reach, cuts, n)
    type(sheet_type), intent(in) :: sheet, front   !< slave, master
    integer, intent(in) :: g                       !< the master's facet
    real(DP), intent(in) :: reach                  !< [length]
    type(cut_type), allocatable, intent(inout) :: cuts(:)
    integer, intent(inout) :: n                    !< cuts so far
    type(cut_type) :: cut
    real(DP) :: own(2, MAX_FACE_NODES), window(2, 4)
    integer :: pieces(4, 5), n_pieces, k, m
    if (dot_product(front%normal, sheet%normal) > -FACING) return
    own(:, :sheet%n) = in_plane(sheet, sheet%x(:, outline_of(sheet)))
    call list_pieces(front%kind, pieces, n_pieces)
    cut%master = g
    own(2, :) = -own(2, :)                         ! seen from the master: there its corners run counter-clockwise
    do k = 1, n_pieces
      m = count(pieces(:, k) > 0)
      window(:, :m) = in_plane(sheet, front%x(:, as_numbered(front, pieces(:m, k))))
      window(2, :m) = -window(2, :m)
      if (any(minval(own(:, :sheet%n), dim=2) > maxval(window(:, :m), dim=2))) cycle
      if (any(maxval(own(:, :sheet%n), dim=2) < minval(window(:, :m), dim=2))) cycle
      call clip_polygon(own(:, :sheet%n), window(:, :m), cut%corners, cut%n)
      if (cut%n < 3) cycle
      if (abs(polygon_area(cut%corners(:, :cut%n))) <= SLIVER * abs(polygon_area(own(:, :sheet%n)))) cycle
      cut%corners(2, :) = -cut%corners(2, :)
      cut%distance = distance_between(sheet, front, sum(cut%corners(:, :cut%n), dim=2) / real(cut%n, DP))
      if (abs(cut%distance) > reach) cycle
      if (n == size(cuts)) cuts = [cuts, cuts]
      n = n + 1
      cuts(n) = cut
    end do
  end subroutine cut_with


  !> Points in the coordinates of the plane of a sheet.
  pure function in_plane(sheet, x) result(p)
    type(sheet_type), intent(in) :: sheet
    real(DP), intent(in) :: x(:, :)                !< (3, n) [length]
    real(DP) :: p(2, size(x, 2))                   !< [length]
    p = matmul(transpose(sheet%axes), x - spread(sheet%origin, 2, size(x, 2)))
  end function in_plane


  !> How far two sheets are apart over a point of the plane of the first.
  pure real(DP) function distance_between(sheet, front, q) result(distance)
    type(sheet_type), intent(in) :: sheet, front
    real(DP), intent(in) :: q(2)                   !< in the plane of `sheet` [length]
    distance = dot_product(sheet%normal, point_at(front, natural_place(front, sheet, q)) &
      - point_at(sheet, natural_place(sheet, sheet, q)))
  end function distance_between


  !> Where masters lie one behind the other the nearest takes the place: what overlaps with a nearer cut is dropped (n = 0).
  subroutine drop_behind(sheet, cuts, n_cuts)
    type(sheet_type), intent(in) :: sheet
    type(cut_type), intent(inout) :: cuts(:)
    integer, intent(in) :: n_cuts
    logical :: is_done(n_cuts), is_kept(n_cuts)
    real(DP) :: own(2, MAX_FACE_NODES), common(2, MAX_CORNERS), covered, area
    integer :: i, j, k, n
    own(:, :sheet%n) = in_plane(sheet, sheet%x(:, outline_of(sheet)))
    area = polygon_area(own(:, :sheet%n))
    covered = 0.0_DP
    do i = 1, n_cuts
      covered = covered + polygon_area(cuts(i)%corners(:, :cuts(i)%n))
    end do
    if (covered <= (1 + OVERLAP) * area) return
    is_done = .false.
    is_kept = .false.
    do k = 1, n_cuts
      i = minloc(abs(cuts(:n_cuts)%distance), dim=1, mask=.not. is_done)
      is_done(i) = .true.
      is_kept(i) = .true.
      do j = 1, n_cuts
        if (.not. is_kept(j) .or. j == i) cycle
        call clip_polygon(cuts(i)%corners(:, :cuts(i)%n), cuts(j)%corners(:, :cuts(j)%n), common, n)
        if (n >= 3) is_kept(i) = is_kept(i) .and. polygon_area(common(:, :n)) <= OVERLAP * area
      end do
    end do
    where (.not. is_kept) cuts(:n_cuts)%n = 0
  end subroutine drop_behind


  !> Appends the points of a cut: triangles about the mean of its corners; a cut of three corners is one itself.
  subroutine add_points(sheet, f, is_line, depth, front, cut, points, n)
    type(sheet_type), intent(in) :: sheet, front   !< slave, master
    integer, intent(in) :: f                       !< the slave's facet
    logical, intent(in) :: is_line                 !< the slave's facet is a line
    real(DP), intent(in) :: depth                  !< of a line, as find_facing has it
    type(cut_type), intent(in) :: cut
    type(facing_type), allocatable, intent(inout) :: points(:)
    integer, intent(inout) :: n                    !< points so far
    real(DP) :: natural(2, MAX_CORNERS), triangle(2, 3), middle(2)
    integer :: k
    do k = 1, cut%n
      natural(:, k) = natural_place(sheet, sheet, cut%corners(:, k))
    end do
    if (cut%n == 3) then
      call add_triangle(natural(:, [3, 1, 2]))
      return
    end if
    middle = natural_place(sheet, sheet, sum(cut%corners(:, :cut%n), dim=2) / real(cut%n, DP))
    do k = 1, cut%n
      triangle(:, 1) = middle
      triangle(:, 2) = natural(:, k)
      triangle(:, 3) = natural(:, modulo(k, cut%n) + 1)
      call add_triangle(triangle)
    end do

  contains

    !> Seven points.
    subroutine add_triangle(corners)
      real(DP), intent(in) :: corners(2, 3)        !< natural coordinates [-]
      real(DP) :: share(3, N_RULE), weight(N_RULE), a(2), b(2), twice, tangents(3, 2)
      type(facing_type) :: point
      integer :: q
      a = corners(:, 2) - corners(:, 1)
      b = corners(:, 3) - corners(:, 1)
      twice = a(1) * b(2) - a(2) * b(1)
      if (twice < 2 * LEAST) return
      call seven_points(share, weight)
      do q = 1, N_RULE
        point%slave = f
        point%master = cut%master
        point%at = matmul(corners, share(:, q))
        tangents = tangents_at(sheet, point%at)
        point%area = 0.5_DP * twice * weight(q) * norm2(cross_product(tangents(:, 1), tangents(:, 2)))
        if (is_line) point%area = point%area * merge(depth, PI / sin(HALF_WEDGE), depth >= 0.0_DP)
        point%xi = nearest_place(front, point_at(sheet, point%at))
        if (n == size(points)) points = [points, points]
        n = n + 1
        points(n) = point
      end do
    end subroutine add_triangle

  end subroutine add_points


  !> The rule of seven points on a triangle: area coordinates and weights, whose sum is 1.
  pure subroutine seven_points(share, weight)
    real(DP), intent(out) :: share(3, N_RULE), weight(N_RULE)   !< [-]
    real(DP), parameter :: ROOT = sqrt(15.0_DP)
    integer, parameter :: AT(3) = [2, 1, 3]        ! the order of the last three
    integer :: k
    share(:, 1) = 1.0_DP / 3
    weight(1) = 9.0_DP / 40
    share(:, 2:4) = (6 - ROOT) / 21
    weight(2:4) = (155 - ROOT) / 1200
    share(:, 5:7) = (6 + ROOT) / 21
    weight(5:7) = (155 + ROOT) / 1200
    do k = 1, 3
      share(k, 1 + k) = (9 + 2 * ROOT) / 21
      share(AT(k), 4 + k) = (9 - 2 * ROOT) / 21
    end do
  end subroutine seven_points


  !> The natural coordinates of the point of a sheet that is over a point of a plane.
  pure function natural_place(sheet, plane, q) result(xi)
    type(sheet_type), intent(in) :: sheet
    type(sheet_type), intent(in) :: plane          !< the sheet whose plane it is
    real(DP), intent(in) :: q(2)                   !< in the plane [length]
    real(DP) :: xi(2)                              !< [-]
    real(DP) :: N(MAX_FACE_NODES)
    call place_on_flat(sheet%kind, in_plane(plane, sheet%x(:, :sheet%n)), q, xi, N)
  end function natural_place


  !> The natural coordinates of the point of a sheet that is nearest to a point, on the sheet or at its border.
  pure function nearest_place(sheet, point) result(xi)
    type(sheet_type), intent(in) :: sheet
    real(DP), intent(in) :: point(3)               !< [length]
    real(DP) :: xi(2)                              !< [-]
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    real(DP) :: t(3, 2), bend(3, 3), d(3), H(2, 2), g(2), step(2), det
    integer :: iteration
    logical :: is_triangle
    is_triangle = sheet%kind == FACET_TRI3 .or. sheet%kind == FACET_TRI6
    xi = merge(1.0_DP / 3, 0.0_DP, is_triangle)
    do iteration = 1, MOST_ITERATIONS
      call facet_shapes(sheet%kind, xi, N, dN, ddN)
      associate (x => sheet%x(:, :sheet%n))
        d = matmul(x, N(:sheet%n)) - point
        t = matmul(x, transpose(dN(:, :sheet%n)))
        bend = matmul(x, transpose(ddN(:, :sheet%n)))
      end associate
      g = matmul(d, t)
      H = matmul(transpose(t), t)
      det = H(1, 1) * H(2, 2)
      H = H + reshape([dot_product(d, bend(:, 1)), dot_product(d, bend(:, 3)), dot_product(d, bend(:, 3)), &
        dot_product(d, bend(:, 2))], [2, 2])
      if (H(1, 1) <= 0.0_DP .or. H(1, 1) * H(2, 2) - H(1, 2)**2 <= 1.0e-6_DP * det) H = matmul(transpose(t), t)
      det = H(1, 1) * H(2, 2) - H(1, 2)**2
      if (det <= tiny(1.0_DP)) exit
      step = -[H(2, 2) * g(1) - H(1, 2) * g(2), H(1, 1) * g(2) - H(1, 2) * g(1)] / det
      if (maxval(abs(step)) > 1.0_DP) step = step / maxval(abs(step))
      xi = xi + step
      if (maxval(abs(step)) < 1.0e-13_DP) exit
    end do
    if (is_triangle) then
      xi = max(xi, 0.0_DP)
      if (sum(xi) > 1.0_DP) xi = xi / sum(xi)
    else
      xi = min(max(xi, -1.0_DP), 1.0_DP)
    end if
  end function nearest_place


  !> The unit normal of a facet at natural coordinates, out of the body.
  pure function face_normal(facets, x, f, xi) result(normal)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    integer, intent(in) :: f                       !< facet
    real(DP), intent(in) :: xi(2)                  !< [-]
    real(DP) :: normal(3), t(3, 2)
    call facet_tangents(facets, x, f, xi, t)
    normal = cross_product(t(:, 1), t(:, 2))
    normal = normal / max(norm2(normal), tiny(1.0_DP))
  end function face_normal

end module amontons_face_integration_points
